"""The verdicts: each way to spoil a run is named, with what to do, and a good run passes."""

import json
from pathlib import Path

import numpy as np
import pytest

from calib.base.names import G
from calib.logs.read import read_log
from calib.run.check import check, facts, problems_for, to_dict
from tests.support.made_runs import BAR_PER_G, changed, made_run, ramp, stop, with_slip
from tests.support.one_axle import one_axle
from tests.support.reference_car import REAL, noisy, swapped, without

SAMPLES = Path(__file__).parents[2] / "sample_logs"

PURPOSES = ["fit", "validate", "coast", "diagnose"]
FIT = ["fit", "validate", "diagnose"]
COAST = ["coast", "diagnose"]
STOP = ["validate", "diagnose"]


def usable(log):
    return [v.purpose for v in check(log).verdicts if v.usable]


def reasons(log, purpose="fit"):
    return " | ".join(problems_for(log, purpose))


def warned(log):
    return " | ".join(one.text for one in check(log).warnings)


@pytest.mark.parametrize("rate", [40.0, 100.0, 200.0, 500.0, 1000.0])
def test_good_runs_pass_at_every_rate(rate):
    assert usable(made_run(ramp(), rate=rate)) == FIT
    assert usable(made_run(stop(), rate=rate)) == STOP
    assert usable(made_run(lambda t: 0.0 * t, rate=rate)) == COAST


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_good_run_is_not_complained_of(noise):
    assert check(made_run(noise=noise)).warnings == ()


@pytest.mark.parametrize(
    ("name", "purposes"),
    [
        ("sedan/ramp_wet_asphalt.csv", FIT),
        ("sedan/ramp_wet_asphalt_repeat.csv", FIT),
        ("sedan/dry_asphalt_stop.csv", STOP),
        ("sedan/basalt_wet_pads.csv", STOP),
        ("sedan/wet_tile_wet_pads.csv", STOP),
        ("sedan/transition_dry_to_basalt.csv", STOP),
        ("sedan/coast.csv", COAST),
        ("simulation_study/ramp_noisy.parquet", FIT),
        ("simulation_study/stop_noisy.parquet", STOP),
        ("third_party/cal_ramp.parquet", FIT),
        ("third_party/hold1_const_mu30.parquet", STOP),
    ],
)
def test_samples_serve_what_they_were_driven_for(name, purposes):
    assert usable(read_log(SAMPLES / name)) == purposes


@pytest.mark.parametrize("channel", ["p_mc", "a_x", "omega_rr"])
def test_missing_channel(channel):
    log = changed(made_run(), **{channel: None})
    findings = check(log)
    assert findings.seen.missing == (channel,)
    assert not findings.usable
    assert all(f"{channel} is missing" in reasons(log, p) for p in FIT)


@pytest.mark.parametrize("rate", [20.0, 2000.0])
def test_clock_too_slow_or_fast(rate):
    assert f"{rate:g} Hz" in reasons(made_run(rate=rate), "validate")


def test_no_unbraked_part():
    log = made_run(ramp(start=-1.0))
    assert "0.00 s of steady rolling" in reasons(log, "fit")
    assert "0.00 s of steady rolling" in reasons(log, "validate")


def test_short_unbraked_part_is_warned_of():
    assert "lead_in is 0.85" in warned(made_run(ramp(start=0.7)))


def test_no_braking():
    assert "no braking: drive a slow pressure ramp" in reasons(made_run(lambda t: 0.0 * t))


def test_step_is_no_ramp():
    assert "press slowly" in reasons(made_run(stop()))


def test_ramp_that_does_not_go_far():
    assert "brake up to 0.35 g" in reasons(made_run(ramp(rate=4.0, top=15.0)))


def test_ramp_from_too_low_a_speed():
    assert "from a higher speed" in reasons(made_run(ramp(rate=15.0), speed=6.0))


def test_pumped_pedal_is_no_ramp():
    log = made_run(lambda t: 10.0 * np.maximum(np.sin(4.0 * (t - 1.5)), 0.05) * (t > 1.5))
    assert "fit" not in usable(log)


def test_pedal_that_is_let_go_within_a_ramp_is_named():
    """Up to 0.22 g, back to 0.14 g and on to 0.37 g: no rise spans the 0.25 g of a ramp."""
    z = [0.0, 0.22, 0.14, 0.37]
    log = made_run(lambda t: BAR_PER_G * np.interp(t, [1.5, 3.7, 3.9, 6.2], z))
    assert "fit" not in usable(log)
    assert "but not in one rise" in reasons(log)
    assert "do not let the pedal go in between" in reasons(log)


def test_standstill():
    log = made_run(lambda t: 0.0 * t, speed=0.0)
    findings = check(log)
    assert not findings.usable
    assert "the car is too slow" in reasons(log, "diagnose")
    assert findings.seen.standing == pytest.approx(8.0, abs=0.1)


def test_standstill_after_a_stop_is_no_fault():
    log = made_run(stop(), speed=20.0, duration=12.0, noise=0.0)
    assert usable(log) == STOP
    assert "standing is" in warned(log)


@pytest.mark.parametrize("channel", ["omega_fl", "omega_rr", "a_x"])
def test_constant_sensor(channel):
    log = made_run(stop(end=5.0))
    log = changed(log, **{channel: np.full(log.time.size, log[channel][0])})
    assert usable(log) == []
    assert f"{channel} does not change from 0.00" in reasons(log, "validate")


def test_wrong_sign_of_a_x():
    log = made_run()
    wrong = changed(log, a_x=-log["a_x"])
    assert "a_x is positive while the wheels slow down" in reasons(wrong, "validate")
    assert "sign = -1" in reasons(wrong, "validate")


def test_a_x_in_another_unit_than_it_says():
    log = made_run()
    assert "check the unit" in reasons(changed(log, a_x=log["a_x"] / G), "validate")
    assert "check the unit" in reasons(changed(log, a_x=log["a_x"] * G), "validate")


def test_swapped_axles():
    log = made_run(stop())
    axles = {f"omega_{a}{s}": log[f"omega_{b}{s}"] for a, b in ("fr", "rf") for s in "lr"}
    swapped = changed(log, **axles)
    assert "axles_swapped is -0.00" in warned(swapped)
    assert "axles_swapped" not in warned(log)
    (warning,) = (w for w in check(swapped).warnings if w.code == "axles_swapped")
    assert "swapped" in warning.causes[0]
    assert any("front pads that are weak" in cause for cause in warning.causes)
    assert any("regeneration" in cause for cause in warning.causes)
    assert any("all-wheel drive" in cause for cause in warning.causes)
    assert usable(swapped) == STOP


def test_a_ramp_with_the_rear_axle_only_is_not_taken_for_swapped():
    log = noisy(one_axle(REAL, "r", faster=1.3), 0)
    assert "swapped" not in warned(log)
    assert "fit" in usable(log)
    assert any("the rear tyres' stiffness" in use for use in check(log).uses)
    assert "the rear wheels must slip more" in warned(swapped(log))
    other = without(log, *(f"p_{a}{s}" for a in "fr" for s in "lr"))
    assert "axles_swapped is" in warned(other)


def test_a_ramp_with_one_axle_may_be_shorter():
    log = noisy(one_axle(REAL, "r"), 0)
    assert reasons(log) == ""
    assert "the ramp spans 0.1" in reasons(noisy(one_axle(REAL, "r", faster=0.5), 0))
    other = without(log, *(f"p_{a}{s}" for a in "fr" for s in "lr"))
    assert "the ramp spans" in reasons(other)


def test_abs_spoils_a_ramp_but_not_a_stop():
    assert "ABS works from 4.0" in reasons(with_slip(made_run(ramp()), ["fl"], 4.0, 0.4, 0.3))
    log = with_slip(made_run(stop()), ["fl"], 3.0, 0.4, 0.3)
    assert usable(log) == STOP
    assert "ABS works on fl from 3.0" in warned(log)


def test_locked_wheel():
    log = made_run(ramp())
    log = changed(log, omega_rl=np.where(log.time > 4.0, 0.0, log["omega_rl"]))
    assert "wheel rl locks" in reasons(log)


def test_gap_within_the_ramp():
    log = made_run(ramp())
    keep = (log.time < 3.0) | (log.time > 3.4)
    log = changed(log, **{name: x[keep] for name, x in log.channels.items()})
    assert "0.40 s are missing" in reasons(log).replace("0.41", "0.40")
    assert "the longest of 1 gaps" in warned(log)


def test_saturated_pressure():
    log = made_run(ramp(rate=10.0, top=60.0))
    log = changed(log, p_mc=np.minimum(log["p_mc"], 30e5))
    assert "p_mc is at the end of its range" in reasons(log)


@pytest.mark.parametrize("factor", [100.0, 0.01, -1.0])
def test_pressure_that_is_none(factor):
    log = made_run()
    assert "check its" in reasons(changed(log, p_mc=factor * log["p_mc"]), "validate")


def test_pressure_that_is_computed():
    log = made_run(ramp())
    computed = np.where(log.time > 1.5, np.maximum(log["p_mc"], 0.0), 0.0)
    assert "pressure_computed is" in warned(changed(log, p_mc=computed))
    assert "pressure_computed" not in warned(log)


def test_different_tyres():
    log = made_run()
    log = changed(log, **{f"omega_r{s}": 0.987 * log[f"omega_r{s}"] for s in "lr"})
    assert "eta_zero is -0.013, expected -0.008 to 0.008; likely other tyres" in warned(log)
    assert usable(log) == FIT


def test_bend():
    log = made_run()
    log = changed(log, **{f"omega_{a}r": 1.02 * log[f"omega_{a}r"] for a in "fr"})
    assert "sides_f is 0.02, expected" in warned(log)


def test_coarse_wheel_speeds_make_no_table():
    log = made_run(rate=50.0)
    coarse = {f"omega_{w}": np.round(log[f"omega_{w}"] / 0.8) * 0.8 for w in ("fl", "rl")}
    assert "coarse_wheel_speeds is" in warned(changed(log, **coarse))
    rng = np.random.default_rng(1)
    noise = {f"omega_{w}": log[f"omega_{w}"] + rng.normal(size=400) for w in ("fl", "rl")}
    assert "finer and faster" in reasons(changed(log, **noise))


def test_axles_that_slip_alike_make_no_table():
    """Finer wheel speeds would not help: the change of eta is 0, and known well."""
    log = made_run()
    alike = changed(log, **{f"omega_r{s}": log[f"omega_f{s}"] for s in "lr"})
    rotated = {"fl": "fr", "fr": "rr", "rr": "rl", "rl": "fl"}  # one front, one rear on each axle
    for one in (
        alike,
        changed(log, **{f"omega_{a}": log[f"omega_{b}"] for a, b in rotated.items()}),
    ):
        assert "both axles slip alike" in reasons(one)
        assert "finer" not in reasons(one)


def test_no_reference_speed_is_warned_of():
    log = changed(made_run(), v=None)
    assert usable(log) == ["fit", "validate"]
    assert "no reference speed v" in reasons(log, "diagnose")
    assert "no reference speed" in warned(log)


def test_text_and_data():
    findings = check(made_run())
    text = dict(facts(findings))
    assert "200 Hz" in text["clock"]
    assert "braking 1" in text
    data = to_dict(findings)
    assert data["usable"] is True
    assert [v["purpose"] for v in data["verdicts"]] == PURPOSES
    assert json.loads(json.dumps(data))["seen"]["clock"]["samples"] == 1600


@pytest.mark.parametrize("channel", ["p_mc", "omega_fl"])
def test_a_log_that_lacks_something_is_of_no_use(channel):
    findings = check(changed(made_run(), **{channel: None}))
    assert not findings.usable
    assert all(f"{channel} is missing" in verdict.reasons[0] for verdict in findings.verdicts)


READ_AS = {"km/h as m/s": 3.6, "mph as m/s": 2.237, "km/h as mph": 1.609, "mph as km/h": 0.6214,
           "m/s as km/h": 0.2778, "m/s as mph": 0.447}  # fmt: skip


@pytest.mark.parametrize("mistake", READ_AS)
def test_a_speed_in_another_unit_is_named(mistake):
    """A wheel of 0.27 m, with which km/h read as mph makes a radius that other tyres have."""
    log = made_run()
    small = {f"omega_{w}": log[f"omega_{w}"] * 0.32 / 0.27 for w in ("fl", "fr", "rl", "rr")}
    log = changed(log, **small, v=log["v"])
    assert usable(log) == FIT
    log = changed(log, v=READ_AS[mistake] * log["v"])
    assert usable(log) == []
    unit, read_as = mistake.split(" as ")
    assert f"v is in {unit} and was read as {read_as}" in reasons(log)


def test_wheel_speeds_that_are_held_for_too_long():
    log = made_run(rate=100.0)
    held = {f"omega_{w}": np.repeat(log[f"omega_{w}"][::10], 10)[: log.time.size]
            for w in ("fl", "fr", "rl", "rr")}  # fmt: skip
    assert "0.10 s" in reasons(changed(log, **held))
