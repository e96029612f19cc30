"""Mistakes as hypotheses: possible sizes, prior odds, and how to undo each mistake in a run.

To undo a mistake is to add a force that the log lacks, to remove a delay, or to limit the rear
pressure. Pads that differ from the vehicle file are hypotheses too, with nothing to undo. The prior
odds are judgements of how often a mistake occurs.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES, G
from calib.car.effects.hydraulics import behind_valve
from calib.car.forces import mean_slip
from calib.car.vehicle import Axle, Vehicle
from calib.model.ramp import RampRun

USUAL_PADS = 0.1  # standard deviation of ln of the friction of an axle's pads over the file's [1]
_OTHER_PADS = 0.5  # the same where the pads are not those of the file [1]
_FACTORS = (-2.0, -1.0, 0.0, 0.5, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, *map(float, range(6, 13)), 14.0)
"""Factors that correct a logged torque: another sign, one motor of two or three logged, a torque at
the shaft of the motor and not at the wheels."""
_TORQUES = (150.0, 250.0, 400.0, 600.0, 900.0, 1300.0)  # of a motor, at the wheels of an axle [N m]
_FULL = (4e5, 10e5, 20e5)  # pressures at which a motor gives its full torque [Pa]
_HANDS_OVER = (1.0, 4.0)  # speeds between which a motor's torque falls to 0 [m/s]
_KNEES = (10e5, 15e5, 20e5, 25e5, 30e5)  # pressures from which on a valve limits the rear [Pa]
_SLOPES = (0.2, 0.45)  # rise of the rear pressure over that of the front beyond the knee [1]
DELAYS = (0.012, 0.02, 0.03, 0.045, 0.07, 0.1)  # of the wheel speeds of an axle [s]
_DRAGS = (1e5, 2e5, 3e5, 4.5e5, 7e5)  # residual pressures in one brake [Pa]
_LEAST_DRIVE = 20.0  # a smaller logged torque of a braking car is noise [N m]

# Sizes that are tried before all others. Those of a motor and of a valve lie between listed ones.
_FIRST_FACTORS, _FIRST_MOTORS = ((-1.0,), (2.0,), (9.0,)), ((250.0, 8e5), (700.0, 12e5))
_FIRST_DELAYS, _FIRST_DRAGS = ((0.03,), (0.07,)), ((2e5,), (4.5e5,))
_FIRST_KNEES = ((15e5, 0.3), (25e5, 0.3))

SCALE, MOTOR, VALVE = "drive_torque_scale", "motor_not_logged", "rear_pressure_limited"
LATE, DRAG = "wheels_late", "brake_drags"  # codes of the mistakes in `rules.csv`
Size = tuple[float, ...]
"""Parameters of a mistake: (factor,), (torque, pressure), (delay,), (pressure,), (knee, slope)."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A mistake; or no mistake, but pads unlike those of the file."""

    code: str  # of the mistake in `rules.csv`, "" for pads alone
    odds: float  # prior odds, 1 for "nothing wrong" [1]
    sizes: tuple[Size, ...] = ((),)  # equally likely sizes
    first: tuple[Size, ...] = ((),)  # sizes that are tried before the others
    undo: Callable[[RampRun, Size], RampRun] = lambda run, _: run  # return it without the mistake
    pads: tuple[float, float] = (USUAL_PADS, USUAL_PADS)
    """Standard deviation of ln of the friction of front and of rear pads over the file's [1]."""
    axle: str = ""  # axle with the mistake, "f" or "r"


NOTHING_WRONG = Hypothesis("", 1.0)


def hypotheses(car: Vehicle, runs: Sequence[RampRun]) -> Iterator[Hypothesis]:
    """Yield pads unlike those of the file, then all mistakes that these ramps may have."""
    other, usual = _OTHER_PADS, USUAL_PADS
    for pads in ((other, usual), (usual, other), (other, other)):
        yield Hypothesis("", 0.1, pads=pads)
    for axle, brake in zip(AXLES, (car.front, car.rear), strict=True):
        yield from _of_axle(car, runs, axle, brake)
    one_pressure = all(np.array_equal(run.blocks.p_f, run.blocks.p_r) for run in runs)
    if one_pressure and "rear_proportioning" not in car.effects:
        knees = tuple((knee, slope) for knee in _KNEES for slope in _SLOPES)
        yield Hypothesis(VALVE, 0.04, knees, _FIRST_KNEES, _with_valve, axle="r")


def _of_axle(car: Vehicle, runs: Sequence[RampRun], axle: str, brake: Axle) -> Iterator[Hypothesis]:
    """Yield late wheel speeds, a dragging brake, and a motor, logged wrongly or not at all."""
    radius = brake.rolling_radius
    delays, drags = (tuple((x,) for x in sizes) for sizes in (DELAYS, _DRAGS))
    undo = partial(_without_delay, car, axle)
    yield Hypothesis(LATE, 0.01, delays, _FIRST_DELAYS, undo, axle=axle)
    undo = partial(_with_force, axle, partial(_drag_force, brake))
    yield Hypothesis(DRAG, 0.004, drags, _FIRST_DRAGS, undo, axle=axle)
    logged = [np.abs(getattr(run.blocks, f"drive_{axle}")[run.braked]) for run in runs]
    if max(float(np.max(x, initial=0.0)) for x in logged) > _LEAST_DRIVE:
        factors = tuple((factor,) for factor in _FACTORS)
        undo = partial(_with_force, axle, partial(_missing_force, axle, radius))
        yield Hypothesis(SCALE, 0.1, factors, _FIRST_FACTORS, undo, axle=axle)
    elif car.motor_odds > 0.0:
        torques = tuple((torque, full) for torque in _TORQUES for full in _FULL)
        undo = partial(_with_force, axle, partial(_motor_force, radius))
        yield Hypothesis(MOTOR, car.motor_odds, torques, _FIRST_MOTORS, undo, axle=axle)


def _with_force(
    axle: str, force: Callable[[RampRun, Size], Array], run: RampRun, size: Size
) -> RampRun:
    """Return the run with an additional ``force`` [N] (k,), positive if it slows, on an axle."""
    extra, name = force(run, size), f"drag_{axle}"
    return replace(run, **{name: getattr(run, name) + extra, "brake_sum": run.brake_sum - extra})


def _missing_force(axle: str, radius: float, run: RampRun, size: Size) -> Array:
    """Force [N] (k,) that a logged torque lacks if its true value is ``size`` times as large."""
    drive: Array = getattr(run.blocks, f"drive_{axle}")
    return np.asarray((1.0 - size[0]) * drive * run.braked / radius)


def _motor_force(radius: float, run: RampRun, size: Size) -> Array:
    """Force [N] (k,) of a motor whose torque rises with the pressure to its full value.

    ``size`` is the full torque [N m] and the pressure at which it is reached [Pa]. The torque falls
    to 0 at low speed.
    """
    b, (torque, full), (low, high) = run.blocks, size, _HANDS_OVER
    share = np.clip(np.maximum(b.p_f, b.p_r) / full, 0.0, 1.0)
    share *= np.clip((b.speed - low) / (high - low), 0.0, 1.0)
    return np.asarray(torque / radius * share * run.braked)


def _drag_force(brake: Axle, run: RampRun, size: Size) -> Array:
    """Force [N] (k,) of one wheel's brake whose pressure is never below ``size`` [Pa]."""
    gain = brake.torque_gain * brake.pad_friction / brake.rolling_radius
    pressure = np.maximum(run.blocks.p_f, run.blocks.p_r)
    return np.asarray(gain * np.maximum(size[0] - pressure, 0.0))


def _without_delay(car: Vehicle, axle: str, run: RampRun, size: Size) -> RampRun:
    """Return the run without a delay ``size`` [s] of an axle's wheel speeds."""
    radius = (car.front if axle == "f" else car.rear).rolling_radius
    b, name = run.blocks, f"omega_{axle}"
    # a late rim speed of a car that slows is too high by g z times the delay
    b = replace(b, **{name: getattr(b, name) - size[0] * G * b.z / radius})
    slip = None if b.v is None else mean_slip(car, run.load_f, b.omega_f, b.omega_r, b.v)
    return replace(run, blocks=b, slip=slip)


def _with_valve(run: RampRun, size: Size) -> RampRun:
    """Return the run with the rear pressure behind a valve of this knee [Pa] and slope [1]."""
    return replace(run, blocks=replace(run.blocks, p_r=behind_valve(run.blocks.p_r, *size)))
