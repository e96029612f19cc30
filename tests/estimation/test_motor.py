"""A motor that brakes along and is not logged, in a plant: its stops are named, open or held."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning
from calib.estimation.budget import budget
from calib.estimation.estimator import estimate
from calib.estimation.motor import with_motor
from calib.estimation.validate import validate
from tests.support.reference_car import REAL, WET, held, noisy, stop, with_pads, without

CHANNELS = ("T_drive_f", "T_drive_r")
PRESSURE = 30e5


def pedal(t):
    """Share of the pressure of `stop`."""
    return min(max((t - 1.5) / 0.25, 0.0), 1.0)


def fading(v):
    """A motor that hands over to the brakes between 10 and 5 km/h."""
    return min(max((v - 1.4) / 1.4, 0.0), 1.0)


def limited(v):
    """The same, with the torque that its power leaves above 12 m/s."""
    return fading(v) * min(1.0, 12.0 / max(v, 1.0))


KINDS = {
    "with the pedal": (lambda t: min(10.0 * pedal(t), 1.0), None),
    "late, and gone when slow": (lambda t: min(max((t - 1.5) / 0.4, 0.0), 1.0), fading),
    "of little power": (lambda t: min(10.0 * pedal(t), 1.0), limited),
    "as the pedal is pressed": (pedal, fading),
    "on the lift": (lambda t: 1.0, None),
}
"""Share of its torque at a time [s] and at a speed [m/s]."""


def braked_along(kind, torque, axle="front"):
    """A whole stop with pads of the ramp and a motor of ``torque`` [N m a wheel] on an axle."""
    on, share = KINDS[kind]

    def motor(t):
        both = -2.0 * torque * on(t)
        return (both, 0.0) if axle == "front" else (0.0, both)

    plant = replace(REAL, motor=motor, motor_share=share)
    return stop(plant, PRESSURE, duration=20.0)


@pytest.fixture(scope="module")
def table(fitted):
    return fitted


@pytest.mark.parametrize(
    ("kind", "torque"),
    [
        ("with the pedal", 40),
        ("late, and gone when slow", 150),
        ("of little power", 40),
        ("as the pedal is pressed", 40),
        ("on the lift", 150),
    ],
)
def test_a_motor_in_the_stops_is_named_or_held(table, kind, torque):
    """In front, where it moves the pads by 3 to 15 %, of a car whose mass is known."""
    log = without(noisy(braked_along(kind, torque), torque), *CHANNELS)
    (result,) = validate(table, [log])
    if result.estimate.valid.any():
        named = any("motor" in cause for w in result.warnings for cause in w.causes)
        assert named or min(held(result.estimate)) > 0.9


def test_without_a_motor_the_interval_hardly_grows(table):
    log = noisy(stop(WET, 35e5, duration=20.0), 0)
    alone = estimate(table, log, with_laws=False)
    wider = with_motor(log, alone)
    for one, other in ((alone.front, wider.front), (alone.rear, wider.rear)):
        before, now = (np.median(np.log(a.upper / a.lower)[alone.valid]) for a in (one, other))
        assert 1.0 < now / before < 1.2
        assert np.array_equal(other.upper, one.upper, equal_nan=True)
        assert np.array_equal(other.pad_friction, one.pad_friction, equal_nan=True)
    assert np.mean(wider.valid[alone.valid]) > 0.95


def test_a_motor_that_is_logged_leaves_nothing_open(table):
    log = noisy(braked_along("with the pedal", 80), 2)
    alone = estimate(table, log, with_laws=False)
    assert with_motor(log, alone) is alone
    assert min(held(alone)) > 0.9
    one_axle = without(log, "T_drive_r")
    assert with_motor(one_axle, estimate(table, one_axle, with_laws=False)).motor is not None


def test_a_stop_that_is_not_braked_to_the_end_leaves_more_open(table):
    """What hands over to the brakes is seen below 3 m/s only."""
    whole = noisy(stop(WET, 35e5, duration=20.0), 1)
    cut = whole.time < whole.time[-1] - 1.0
    short = replace(whole, channels={name: x[cut] for name, x in whole.channels.items()}, truth={})
    opened = []
    for log in (whole, short):
        e = estimate(table, log, with_laws=False)
        opened.append(float(np.median(with_motor(log, e).motor[0][e.valid])))
    assert opened[1] > 2.0 * opened[0]


def test_what_a_fit_named_on_its_ramp_is_counted(table):
    log = noisy(stop(WET, 35e5, duration=20.0), 1)
    e = estimate(table, log, with_laws=False)
    named = PlausibilityWarning("unexplained_braking_force", "ramp", 0.06, (-0.05, 0.045), (), "")
    free, known = with_motor(log, e), with_motor(log, e, (named,))
    lower = np.log(free.front.lower / known.front.lower)[e.valid]
    assert np.median(lower) > 0.05
    dragged = replace(named, code="unexplained_drag", measured=0.3)
    assert np.all(with_motor(log, e, (dragged,)).rear.lower[e.valid] < free.rear.lower[e.valid])


def test_the_budget_has_the_motor_and_adds_up(table):
    log = noisy(stop(with_pads(REAL, 0.31, 0.27), 35e5, duration=20.0), 3)
    e = with_motor(log, estimate(table, log, with_laws=False))
    for axle, made_of in zip((e.front, e.rear), budget(e), strict=True):
        widths = np.sort((np.log(axle.upper / axle.lower) / (2.0 * Z95))[e.valid])
        assert made_of.parts["motor"] > 0.0
        assert made_of.sigma == pytest.approx(widths[(widths.size - 1) // 2], rel=1e-9)
