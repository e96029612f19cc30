"""The verdicts: each way to spoil a run is named, with what to do, and a good run passes."""

from pathlib import Path

import numpy as np
import pytest

from calib.base.names import WHEELS, G
from calib.logs.read import read_log
from calib.plausibility.check import check, unseen
from calib.run.run import Run
from tests.support.made_runs import BAR_PER_G, changed, made_run, ramp, stop, with_slip
from tests.support.reference_car import REAL, noisy, one_axle, swapped, without
from tests.support.refusals import why_not

SAMPLES = Path(__file__).parents[2] / "sample_logs"
FIT = ["fit", "validate", "diagnose"]
COAST = ["coast", "diagnose"]
STOP = ["validate", "diagnose"]
RAMP, STOPPED = made_run(ramp()), made_run(stop())
WHEEL_PRESSURES = [f"p_{a}{s}" for a in "fr" for s in "lr"]


def coasting(t):
    return 0.0 * t


def usable(log):
    return [v.purpose for v in check(log).verdicts if v.usable]


def reasons(log, purpose="fit"):
    return next(" | ".join(v.reasons) for v in check(log).verdicts if v.purpose == purpose)


def codes(log):
    return {warning.code: warning.measured for warning in check(log).warnings}


def with_wheels(log, speed_of):
    return changed(log, **{f"omega_{w}": speed_of(w) for w in WHEELS})


@pytest.mark.parametrize("rate", [40.0, 200.0, 1000.0])
def test_good_runs_pass_at_every_rate(rate):
    assert usable(made_run(ramp(), rate=rate)) == FIT
    assert usable(made_run(stop(), rate=rate)) == STOP
    assert usable(made_run(coasting, rate=rate)) == COAST


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_a_good_run_has_no_warning(noise):
    assert check(made_run(noise=noise)).warnings == ()


@pytest.mark.parametrize(
    ("name", "purposes"),
    [
        ("sedan/ramp_wet_asphalt.csv", FIT),
        ("sedan/wet_tile_wet_pads.csv", STOP),
        ("sedan/transition_dry_to_basalt.csv", STOP),
        ("sedan/coast.csv", COAST),
        ("simulation_study/ramp_noisy.parquet", FIT),
        ("third_party/hold1_const_mu30.parquet", STOP),
    ],
)
def test_samples_serve_what_they_were_driven_for(name, purposes):
    assert usable(read_log(SAMPLES / name)) == purposes


def gap():
    keep = (RAMP.time < 3.0) | (RAMP.time > 3.4)
    return changed(RAMP, **{name: x[keep] for name, x in RAMP.channels.items()})


def constant(channel):
    log = made_run(stop(end=5.0))
    return changed(log, **{channel: np.full(log.time.size, log[channel][0])})


def rough():
    """A run at 50 Hz with noise of 1 rad/s on one wheel of each axle."""
    log, rng = made_run(rate=50.0), np.random.default_rng(1)
    noisy_ones = {f"omega_{w}": log[f"omega_{w}"] + rng.normal(size=400) for w in ("fl", "rl")}
    return changed(log, **noisy_ones)


def held_wheels():
    log = made_run(rate=100.0)
    return with_wheels(log, lambda w: np.repeat(log[f"omega_{w}"][::10], 10)[: log.time.size])


# Up to 0.22 g, back to 0.14 g and on to 0.37 g: no rise spans the 0.25 g of a ramp.
TWICE = made_run(lambda t: BAR_PER_G * np.interp(t, [1.5, 3.7, 3.9, 6.2], [0, 0.22, 0.14, 0.37]))
PUMPED = made_run(lambda t: 10.0 * np.maximum(np.sin(4.0 * (t - 1.5)), 0.05) * (t > 1.5))
SATURATED = made_run(ramp(rate=10.0, top=60.0))
ROTATED = {"fl": "fr", "fr": "rr", "rr": "rl", "rl": "fl"}  # one front, one rear on each axle
SPOILED = {
    "no p_mc": (changed(RAMP, p_mc=None), "fit", "channel_missing"),
    "no a_x": (changed(RAMP, a_x=None), "validate", "channel_missing"),
    "no wheel": (changed(RAMP, omega_rr=None), "diagnose", "channel_missing"),
    "slow clock": (made_run(rate=20.0), "validate", "clock_rate"),
    "fast clock": (made_run(rate=2000.0), "validate", "clock_rate"),
    "no lead-in": (made_run(ramp(start=-1.0)), "validate", "begins_braked"),
    "coast": (made_run(coasting), "fit", "no_braking"),
    "step": (STOPPED, "fit", "ramp_rise"),
    "short ramp": (made_run(ramp(rate=4.0, top=15.0)), "fit", "ramp_span"),
    "slow car": (made_run(ramp(rate=15.0), speed=6.0), "fit", "ramp_time"),
    "pumped": (PUMPED, "fit", "ramp_rise"),
    "let go": (TWICE, "fit", "ramp_span"),
    "standing": (made_run(coasting, speed=0.0), "diagnose", "too_slow"),
    "constant wheel": (constant("omega_rr"), "validate", "stuck"),
    "constant a_x": (constant("a_x"), "validate", "stuck"),
    "sign": (changed(RAMP, a_x=-RAMP["a_x"]), "validate", "a_x_sign"),
    "a_x in g": (changed(RAMP, a_x=RAMP["a_x"] / G), "validate", "a_x_unit"),
    "a_x by g": (changed(RAMP, a_x=RAMP["a_x"] * G), "validate", "a_x_unit"),
    "a_x unsigned": (changed(RAMP, a_x=np.mod(RAMP["a_x"], 655.36)), "validate", "a_x_beyond_cars"),
    "a_x of another axis": (
        changed(RAMP, a_x=np.random.default_rng(1).normal(0.0, 0.15, RAMP.time.size)),
        "validate", "a_x_foreign",
    ),
    "abs": (with_slip(RAMP, ["fl"], 4.0, 0.4, 0.3), "fit", "abs_in_ramp"),
    "locked": (changed(RAMP, omega_rl=np.where(RAMP.time > 4.0, 0.0, RAMP["omega_rl"])), "fit",
               "locked_in_ramp"),
    "gap": (gap(), "fit", "gap_in_ramp"),
    "saturated": (changed(SATURATED, p_mc=np.minimum(SATURATED["p_mc"], 30e5)), "fit",
                  "end_of_range"),
    "p in kPa": (changed(RAMP, p_mc=100.0 * RAMP["p_mc"]), "validate", "pressure_high"),
    "p in MPa": (changed(RAMP, p_mc=0.01 * RAMP["p_mc"]), "validate", "pressure_per_g"),
    "p negative": (changed(RAMP, p_mc=-RAMP["p_mc"]), "validate", "pressure_low"),
    "noise": (rough(), "fit", "eta_unknown"),
    "held": (held_wheels(), "fit", "wheels_held"),
    "alike": (changed(RAMP, **{f"omega_r{s}": RAMP[f"omega_f{s}"] for s in "lr"}), "fit",
              "eta_alike"),
    "rotated": (with_wheels(RAMP, lambda w: RAMP[f"omega_{ROTATED[w]}"]), "fit", "eta_alike"),
    "no v": (changed(RAMP, v=None), "diagnose", "no_reference_speed"),
}  # fmt: skip


@pytest.mark.parametrize("way", SPOILED)
def test_each_way_to_spoil_a_run_is_named(way):
    log, purpose, code = SPOILED[way]
    assert code in why_not(log, purpose)
    assert purpose not in usable(log)
    assert f"({code})" in reasons(log, purpose)


WARNED = {
    "lead_in": (made_run(ramp(start=0.7)), 0.7),
    "clock_gaps": (gap(), 0.4),
    "eta_zero": (changed(RAMP, **{f"omega_r{s}": 0.987 * RAMP[f"omega_r{s}"] for s in "lr"}),
                 -0.013),
    "sides_f": (changed(RAMP, **{f"omega_{a}r": 1.02 * RAMP[f"omega_{a}r"] for a in "fr"}), 0.02),
    "no_reference_speed": (changed(RAMP, v=None), 1.0),
    "eta_zero_uncertain": (rough(), None),
    "abs": (with_slip(STOPPED, ["fl"], 3.0, 0.4, 0.3), 1.0),
    "axles_swapped": (swapped(STOPPED), None),
}  # fmt: skip


@pytest.mark.parametrize("code", WARNED)
def test_what_does_not_spoil_a_run_is_warned_of(code):
    log, measured = WARNED[code]
    assert code in codes(log)
    assert measured is None or codes(log)[code] == pytest.approx(measured, rel=0.05)
    assert usable(log)


def test_a_ramp_with_the_rear_axle_only_is_not_taken_for_swapped_and_may_be_shorter():
    log = noisy(one_axle(REAL, "r", faster=1.3), 0)
    assert "axles_swapped" not in codes(log)
    assert "fit" in usable(log)
    assert "axles_swapped" in codes(swapped(log))
    assert "axles_swapped" in codes(without(log, *WHEEL_PRESSURES))
    log = noisy(one_axle(REAL, "r"), 0)
    assert reasons(log) == ""
    assert "ramp_span" in reasons(noisy(one_axle(REAL, "r", faster=0.5), 0))
    assert "ramp_span" in reasons(without(log, *WHEEL_PRESSURES))


READ_AS = {"km/h as m/s": 3.6, "mph as m/s": 2.237, "km/h as mph": 1.609, "mph as km/h": 0.6214,
           "m/s as km/h": 0.2778, "m/s as mph": 0.447}  # fmt: skip


@pytest.mark.parametrize("mistake", READ_AS)
def test_a_speed_in_another_unit_is_named(mistake):
    """A wheel of 0.27 m, with which km/h read as mph makes a radius that other tyres have."""
    log = with_wheels(RAMP, lambda w: RAMP[f"omega_{w}"] * 0.32 / 0.27)
    assert usable(log) == FIT
    log = changed(log, v=READ_AS[mistake] * log["v"])
    assert usable(log) == []
    assert "v is in {} and was read as {}".format(*mistake.split(" as ")) in reasons(log)


def test_channels_whose_scale_no_log_shows_are_listed():
    logs = STOPPED, changed(STOPPED, v=None), changed(STOPPED, p_mc=None)
    assert [unseen(Run(log)) for log in logs] == [("p_mc",), ("p_mc", "a_x"), ()]
