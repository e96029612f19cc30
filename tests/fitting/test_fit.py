"""From logs to a table: repeatable, refusing what will not do, and true to a simulated car."""

import math
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.car.balance import front_biased_up_to
from calib.car.vehicle_file import read_vehicle
from calib.fitting.fit import fit
from calib.logs.read import read_log
from calib.logs.write import write_csv, write_parquet
from calib.plausibility.wheels import eta_rise
from calib.run.axle_signals import signals
from calib.run.blocks import blocks
from tests.support.plant import as_log, drive
from tests.support.reference_car import (
    CAR,
    IDEAL,
    REAL,
    SEDAN,
    cut,
    noisy,
    ramp,
    stop,
    swapped,
    with_pads,
    without,
)
from tests.support.refusals import refusal
from tests.support.rounding import jittered

ROOT = SEDAN.parents[1]
LOGS = [SEDAN / f"{n}.csv" for n in ("ramp_wet_asphalt", "coast")]


@pytest.fixture(scope="module")
def clean():
    return ramp(REAL)


@pytest.fixture(scope="module")
def run(clean):
    return noisy(clean, 1)


@pytest.fixture(scope="module")
def table(run):
    return fit(CAR, [run])


@pytest.fixture(scope="module")
def coast():
    return noisy(as_log(drive(REAL, lambda t: 0.0, 33.0, duration=90.0, rtol=1e-7), "coast"), 11)


def refused(*logs, vehicle=CAR):
    return refusal(fit, vehicle, list(logs), kind=LogError)


FIT = """
import sys, calib
car = calib.read_vehicle(sys.argv[1])
print(calib.fit(car, [calib.read_log(path) for path in sys.argv[2:]]).digest)
"""


def test_another_process_and_another_order_of_the_logs_change_no_bit():
    other_process = subprocess.run(
        [sys.executable, "-c", FIT, str(SEDAN / "vehicle.toml"), *map(str, LOGS[::-1])],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONHASHSEED": "2"},
    )
    car = read_vehicle(SEDAN / "vehicle.toml")
    assert fit(car, [read_log(path) for path in LOGS]).digest == other_process.stdout.strip()


def test_truth_is_never_read(run, table):
    lies = replace(run, truth={name: x + 1e3 for name, x in run.truth.items()})
    assert fit(CAR, [lies]).digest == table.digest


def test_units_and_formats_do_not_matter(tmp_path, run):
    """The same run as CSV, as Parquet, and as CSV in kPa, g, km/h and rpm."""
    paths = [tmp_path / "a" / "ramp.csv", tmp_path / "b" / "ramp.parquet", tmp_path / "ramp.csv"]
    for path in paths[:2]:
        path.parent.mkdir()
    write_csv(run, paths[0])
    read = read_log(paths[0])
    write_parquet(read, paths[1])
    units = {"p_mc": ("kPa", 1e-3), "a_x": ("g", 1.0 / 9.80665), "v": ("km/h", 3.6)}
    units |= {f"omega_{w}": ("rpm", 30.0 / math.pi) for w in ("fl", "fr", "rl", "rr")}
    columns = {
        f"{name} [{units.get(name, ('s', 1.0))[0]}]": x * units.get(name, ("s", 1.0))[1]
        for name, x in read.channels.items()
    }
    rows = np.column_stack(list(columns.values()))
    text = "\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows.tolist())])
    paths[2].write_text(text + "\n")
    expected, *others = (fit(CAR, [read_log(path)]) for path in paths)
    for other in others:
        for curve, column, tolerance in (
            ("difference", "D", 1e-9),
            ("paper", "f1", 1e-9),
            ("paper", "f2", 1e-9),
            ("difference", "upper", 1e-8),
            ("tyre", "force", 1e-8),
        ):
            x, y = (getattr(getattr(table, curve), column) for table in (other, expected))
            assert np.max(np.abs(x - y)) < tolerance


@pytest.mark.parametrize("rate", [40.0, 1000.0])
def test_rate_of_the_log_does_not_matter(rate, table, clean):
    """Without noise: what the sampling alone does to D against 200 Hz, over its band."""
    slow = drive(
        REAL, lambda t: 5e5 * max(t - 1.5, 0.0), 33.0, duration=9.5, stop_speed=8.0, rate=rate
    )
    resampled, usual = (fit(CAR, [log]).difference for log in (as_log(slow), clean))
    common = np.linspace(1.0, min(resampled.eta[-1], usual.eta[-1]), 20)
    off = np.interp(common, resampled.eta, resampled.D) - np.interp(common, usual.eta, usual.D)
    assert np.max(np.abs(off)) < 0.05 * np.max(usual.upper - usual.lower)


def test_a_log_without_braking_serves_as_a_coast(table, run, coast):
    with_coast = fit(CAR, [coast, run])
    roles = [(log.name, log.role) for log in with_coast.provenance.logs]
    assert roles == [("ramp", "ramp"), ("coast", "coast")]
    for effect, parameter, truth in (
        ("aerodynamic_drag", "drag_area", 0.66),
        ("rolling_resistance", "coefficient", 0.011),
    ):
        alone, better = (t.effect_values[effect][parameter] for t in (table, with_coast))
        assert better.sigma < 0.7 * alone.sigma
        assert abs(better.value - truth) < 3.0 * better.sigma


@pytest.mark.parametrize(("front", "rear"), [(0.41, 0.36), (0.3, 0.36)])
def test_pad_friction_is_found_within_its_sigma(front, rear):
    clean = ramp(with_pads(REAL, front, rear), slope=5e5 * 0.38 / front)
    ratio = math.log(front / rear)
    c = fit(CAR, [noisy(clean, 0)]).calibration
    truth = {
        "pad_friction_f": front,
        "pad_friction_r": rear,
        "pad_log_ratio": ratio,
        "pad_scale": math.sqrt(front * rear) / 0.38,
    }
    for name, value in truth.items():
        estimate = getattr(c, name)
        assert abs(estimate.value - value) < 3.0 * estimate.sigma
    # eta tells pads and tyres together: of 15 and 10 % that leaves 8.3 % to the ratio, of which
    # each axle has the other one's share; 3 % for the noise and a ratio that drifts
    open_ratio = 0.15 * 0.10 / math.hypot(0.15, 0.10)
    assert c.pad_friction_f.sigma < math.hypot(0.27 * open_ratio, 0.03) * c.pad_friction_f.value
    assert c.pad_friction_r.sigma < math.hypot(0.73 * open_ratio, 0.03) * c.pad_friction_r.value


def test_a_glitch_of_a_x_that_no_car_can_do_takes_no_part(run, table):
    """One sample of 655 m/s^2 is 3.3 g in its block: the rear axle would lift."""
    hit = run["a_x"].copy()
    hit[800] = 655.35
    c = fit(CAR, [replace(run, channels={**run.channels, "a_x": hit})]).calibration
    for name in ("pad_friction_f", "pad_friction_r"):
        assert getattr(c, name).value == pytest.approx(
            getattr(table.calibration, name).value, rel=0.02
        )


# What is refused, and why.


def test_logs_that_are_no_ramp(run, coast):
    bad = replace(cut(run, 1.7), source="bad.csv", digest="bad")
    for logs, reason in (
        ([], "none of the logs"),
        ([coast], "none of the logs holds a braking"),
        ([noisy(stop(), 0)], "ramp_rise"),
        ([cut(run, 0.0, 3.4)], "will not do for a fit"),
        ([cut(run, 1.7)], "lead_in"),
        ([run, bad], "bad.csv"),
        ([run, replace(run, name="copy")], "the same run as plant"),
        ([swapped(run)], "eta_falls"),
    ):
        assert reason in refused(*logs)


def test_a_mistake_of_all_logs_is_named_by_the_one_that_shows_it(run, coast):
    """In a short coast the offset of the wheel speeds looks like another radius."""
    logs = (cut(coast, 0.0, 10.0), run)
    wheels = [f"omega_{w}" for w in ("fl", "fr", "rl", "rr")]
    off = [replace(x, channels={**x.channels, **{w: x[w] + 6.0 for w in wheels}}) for x in logs]
    assert "(rolling_radius_f)" in refused(off[0], run)
    assert "(wheel_offset)" in refused(*off)


@pytest.mark.parametrize(("samples", "hidden"), [(20, ()), (40, ("v",))])
def test_a_wheel_speed_too_coarse_for_a_tyre_curve(clean, samples, hidden):
    """Front left changes only ten or five times a second, so eta shows the steps, not a tyre."""
    log = noisy(clean, 1)
    repeated = np.repeat(log["omega_fl"][::samples], samples)[: log.time.size]
    coarse = replace(log, channels={**log.channels, "omega_fl": repeated})
    assert refused(without(coarse, *hidden))


def test_a_rear_biased_car_is_refused_for_what_it_is():
    """It has eta below one, as its vehicle file says; no curve over eta can hold that."""
    odd = replace(CAR, rear=replace(CAR.rear, piston_area=2.5 * CAR.rear.piston_area))
    assert front_biased_up_to(odd) == 0.0
    log = noisy(ramp(replace(IDEAL, vehicle=odd), slope=2.5e5), 0)
    b = blocks(signals(log, odd.rear.rolling_radius))
    rise, error = eta_rise(b, b.z > 0.1)
    assert rise < -4.0 * error
    assert "swapped" in refused(log)
    assert "eta does not rise under braking" in refused(log, vehicle=odd)


def test_vehicle_of_another_car(run):
    other = read_vehicle(ROOT / "sample_logs/third_party/vehicle.toml")  # R = 0.344 m
    message = refused(run, vehicle=other)
    assert "(rolling_radius_f)" in message
    assert "0.322 m" in message


# The explicit round trip: what `simulate` makes, `fit` finds.


def test_levels_of_the_runs_are_averaged_and_their_spread_counts(clean):
    """The second ramp has pads 5 % stronger: the mean, known to half of it over the root of 2."""
    logs = [noisy(clean, 1), noisy(ramp(with_pads(REAL, 0.40, 0.40), name="second"), 2)]
    pair, alone = (fit(CAR, chosen).calibration for chosen in (logs, logs[:1]))
    # front share 0.73: the level moves against a ratio that is off by 0.23 of it
    off = 0.23 * abs(pair.pad_log_ratio.value)
    assert pair.pad_scale.value == pytest.approx((1.0 + 0.40 / 0.38) / 2.0, abs=0.01 + off)
    spread = 0.5 * (0.40 / 0.38 - 1.0) / math.sqrt(2.0)
    assert pair.pad_scale.sigma > spread
    assert pair.pad_scale.sigma > alone.pad_scale.sigma


def test_whole_milliseconds_move_no_pad(tmp_path):
    run = drive(REAL, lambda t: 8e5 * max(t - 1.5, 0.0), 33.0, duration=7.0, rate=300.0)
    true = noisy(as_log(run, "ramp"), 1)
    rounded = replace(true, channels={**true.channels, "time": np.round(true.time, 3)})
    write_csv(rounded, tmp_path / "ramp.csv")
    read = read_log(tmp_path / "ramp.csv")
    assert len(read.notes) == 1
    pads = [fit(CAR, [log]).calibration for log in (true, read)]
    for axle in ("pad_friction_f", "pad_friction_r"):
        exact, rounded_friction = (getattr(x, axle).value for x in pads)
        assert rounded_friction == pytest.approx(exact, rel=0.005)


def test_a_fit_does_not_hang_on_the_last_digits(fitted):
    other = fit(CAR, [jittered(noisy(ramp(REAL), 1), 2)])
    for name, draws in vars(fitted.draws).items():
        if isinstance(draws, np.ndarray) and draws.dtype == float:
            low, high = np.quantile(draws, [0.025, 0.975], axis=0)
            moved = np.abs(
                np.quantile(vars(other.draws)[name], [0.025, 0.5, 0.975], axis=0)
                - np.quantile(draws, [0.025, 0.5, 0.975], axis=0)
            )
            assert np.all(moved <= 1e-4 * (high - low)), name
    assert [x.code for x in other.warnings] == [x.code for x in fitted.warnings]
