"""Motors and valves that the log lacks or has wrong are named, on a plant that knows them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from calib.fitting.evidence import HypothesisEvidence
from calib.fitting.hypotheses import Hypothesis
from calib.fitting.mistakes import causes_of, named
from calib.logs.log import Log
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, prepared, ramp

TORQUE, FULL = 450.0, 8e5
"""Largest torque of a motor on the front wheels [N m], and the pressure of that torque [Pa]."""


def pressure(t: float) -> float:
    return 5e5 * max(t - 1.5, 0.0)


def torque(t: float) -> float:
    return -TORQUE * min(pressure(t) / FULL, 1.0)


@cache
def electric() -> Log:
    """A ramp in which a motor also brakes the front wheels; its torque is in the log."""
    plant = replace(REAL, motor=lambda t: (torque(t), 0.0))
    return noisy(as_log(drive(plant, pressure, 33.0, duration=9.5, stop_speed=8.0), "ramp"), 4)


@cache
def valved() -> Log:
    """A ramp of a car with a valve behind: p_mc alone is in the log."""
    rear = lambda t: min(pressure(t), 15e5 + 0.3 * max(pressure(t) - 15e5, 0.0))  # noqa: E731
    pressures = {"fl": pressure, "fr": pressure, "rl": rear, "rr": rear}
    run = drive(REAL, pressure, 33.0, duration=9.5, stop_speed=8.0, wheel_pressure=pressures)
    log = noisy(as_log(run, "ramp"), 5)
    return replace(log, channels={k: x for k, x in log.channels.items() if k[:3] not in WHEELS})


WHEELS = ("p_f", "p_r")


def scaled(factor: float | None) -> Log:
    """The electric car with T_drive times a factor; without the channel for None."""
    channels = {k: x for k, x in electric().channels.items() if not k.startswith("T_drive")}
    if factor is not None:
        channels["T_drive_f"] = factor * electric()["T_drive_f"]
    return replace(electric(), channels=channels)


def causes(log: Log):
    return causes_of(CAR, [prepared(log)])


@pytest.mark.parametrize(
    ("factor", "undone"),
    [(0.5, (1.7, 2.3)), (0.1, (8.5, 12.0)), (-1.0, (-1.2, -0.8)), (1 / 3, (2.5, 3.6))],
)
def test_a_wrong_torque_is_named_with_the_factor_that_fits(factor, undone):
    first = named(causes(scaled(factor)))[0]
    assert (first.hypothesis.code, first.hypothesis.axle) == ("drive_torque_scale", "f")
    assert undone[0] <= first.size[0] <= undone[-1]


def test_a_motor_that_is_not_logged_is_named_with_its_torque():
    first, *others = named(causes(scaled(None)))
    assert (first.hypothesis.code, first.hypothesis.axle) == ("motor_not_logged", "f")
    assert 0.5 * TORQUE < first.size[0] < 1.5 * TORQUE
    assert not others


def test_a_motor_of_any_size_is_told_from_a_valve():
    """Its torque, and the pressure of full torque, lie between the sizes that are tried first."""
    motor = lambda t: (0.0, -250.0 * min(pressure(t) / 12e5, 1.0))  # noqa: E731
    run = drive(replace(REAL, motor=motor), pressure, 33.0, duration=9.5, stop_speed=8.0)
    log = noisy(as_log(run, "ramp"), 12)
    log = replace(log, channels={k: x for k, x in log.channels.items() if k[:7] != "T_drive"})
    first, *others = named(causes(log))
    assert (first.hypothesis.code, first.hypothesis.axle) == ("motor_not_logged", "r")
    assert first.size == pytest.approx((250.0, 12e5), rel=0.2)
    assert not others


def test_a_car_without_motors_is_not_asked_for_one():
    car = replace(CAR, motor_odds=0.0)
    codes = {c.hypothesis.code for c in causes_of(car, [prepared(scaled(None))])}
    assert "motor_not_logged" not in codes


def test_a_valve_is_named_with_its_knee():
    first = named(causes(valved()))[0]
    assert first.hypothesis.code == "rear_pressure_limited"
    assert first.size[0] == pytest.approx(15e5, rel=0.4)


@pytest.mark.parametrize("axle", ["f", "r"])
def test_wheel_speeds_that_are_late_are_named_with_their_delay(axle):
    log = noisy(ramp(REAL), 8)
    wheels = [f"omega_{axle}{side}" for side in "lr"]
    late = {w: np.interp(log.time - 0.05, log.time, log[w]) for w in wheels}
    first = named(causes(replace(log, channels={**log.channels, **late})))[0]
    assert (first.hypothesis.code, first.hypothesis.axle) == ("wheels_late", axle)
    assert first.size[0] == pytest.approx(0.05, abs=0.02)


def test_a_brake_that_drags_is_named_with_its_pressure():
    pressures = dict.fromkeys(("fr", "rl", "rr"), pressure)
    pressures["fl"] = lambda t: max(pressure(t), 5e5)
    run = drive(REAL, pressure, 33.0, duration=9.5, stop_speed=8.0, wheel_pressure=pressures)
    log = noisy(as_log(run, "ramp"), 9)
    log = replace(log, channels={k: x for k, x in log.channels.items() if k[:3] not in WHEELS})
    first = named(causes(log))[0]
    assert (first.hypothesis.code, first.hypothesis.axle) == ("brake_drags", "f")
    assert first.size[0] == pytest.approx(5e5, rel=0.4)


@pytest.mark.parametrize("log", [lambda: noisy(ramp(REAL), 6), lambda: scaled(1.0)])
def test_nothing_is_named_where_nothing_is_wrong(log):
    assert named(causes(log())) == ()


def test_nothing_is_named_where_nothing_explains_the_ramp():
    log = noisy(ramp(REAL), 7)
    shaken = {w: log[w] * (1.0 + 0.01 * np.sin(3.0 * log.time)) for w in ("omega_fl", "omega_fr")}
    assert named(causes(replace(log, channels={**log.channels, **shaken}))) == ()


@pytest.mark.parametrize("blocks", [5, 60])
def test_misfit_is_a_mean_square_of_as_many_residuals_as_there_are(blocks):
    """k of the forces, one sigma each, and 2 k of the wheels, 0 each: k/(3 k); k is 14 at most."""
    run = prepared(noisy(ramp(REAL), 6))
    first = np.flatnonzero(run.braked)[0]
    run = replace(run, use=run.use & (np.arange(run.use.size) < first + blocks))
    evidence, k = HypothesisEvidence(CAR, [run], other_road=False), min(blocks, 14)
    fitted = evidence._solution
    exact = fitted._replace(mean=0.0 * fitted.mean, data=0.0 * fitted.data)
    level = evidence._level._replace(square=float(k))
    _, misfit = evidence._weighed(Hypothesis("", 1.0), level, exact)
    assert misfit == pytest.approx(1.0 / 3.0)


def test_what_no_draw_explains_is_no_reason_to_end(monkeypatch):
    weighed, never = HypothesisEvidence._weighed, (-np.inf, np.nan)
    no_pads = lambda e, h, *more: weighed(e, h, *more) if h.code else never  # noqa: E731
    monkeypatch.setattr(HypothesisEvidence, "_weighed", no_pads)
    all_causes = causes(noisy(ramp(REAL), 6))
    assert all(np.isfinite(cause.log_odds) for cause in all_causes)
    named(all_causes)
