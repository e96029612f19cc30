"""All that one run says against its sensors, from fit, estimate and diagnosis alike.

A quantity of the run, its sigma, and the range of its code in `base/warnings.csv`: what lies
outside is told. Nothing here changes an estimate.
"""

import math
from collections.abc import Iterator

import numpy as np

from calib.base.names import WHEELS, G
from calib.base.units import from_si
from calib.base.warning import Measured, PlausibilityWarning, judged, relative, warning
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.plausibility.motor import motor_of
from calib.plausibility.wheel_signals import lost_pulses, slip_of_v
from calib.run.accelerometer import Accelerometer
from calib.run.axle_signals import HELD, Signals, held_time, rolling_radii, wheels_held
from calib.run.brake_response import BrakeResponse
from calib.run.copies import twice
from calib.run.limits import LIMITS
from calib.run.speed_delay import USUAL
from calib.run.warnings import impossible_samples

COMPARED = (*(f"omega_{w}" for w in WHEELS), "v", "a_x", "p_mc")

LIKELY = 0.5
"""Chance of a slope that changes from which it is named [1]."""
MOTOR_LIKELY = 0.4
"""Chance of a motor from which it is named [1]: what is named too often costs a look, a motor that
is not named stands in the pads."""


def run_warnings(
    log: Log,
    s: Signals,
    vehicle: Vehicle,
    sensor: Accelerometer,
    response: BrakeResponse | None,
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on a run.

    ``s`` its signals as read, known effects taken out; ``vehicle`` with the pads that are expected;
    ``sensor`` the accelerometer as judged over the run; ``response`` of its brakes to the pressure.
    """
    measured = (
        *of_wheels(log, vehicle, s),
        *of_pressure(s),
        *of_accelerometer(sensor),
        *of_brakes(response, vehicle.motor_odds),
    )
    return (*channel_warnings(log, s), *judged(log.name, measured))


def channel_warnings(log: Log, s: Signals) -> Iterator[PlausibilityWarning]:
    """Samples that no car drives, one signal twice, values that are held or late."""
    yield from impossible_samples(log)
    for one, other, same in twice(log, [name for name in COMPARED if name in log]):
        limits = (0.0, LIMITS.copy_correlation)
        yield warning("same_signal", log.name, same, limits, one=one, other=other)
    if "v" in log and s.v is None and not s.delay.late:
        yield warning("v_held", log.name, held_time(log), (0.0, HELD))
    longest = wheels_held(log)
    if longest > LIMITS.wheels_held:
        yield warning("wheels_held", log.name, longest, (0.0, LIMITS.wheels_held))
    if s.delay.late:
        used = "v was put in time" if s.delay.sharp else "v is not used"
        yield warning("v_late", log.name, s.delay.value, (0.0, 3.0 * USUAL), used=used)


def of_wheels(log: Log, vehicle: Vehicle, s: Signals) -> Iterator[Measured]:
    """Wheels of another size, a v that was made of them, lost pulses."""
    axles = (("f", vehicle.front), ("r", vehicle.rear))
    for (side, axle), radius in zip(axles, rolling_radii(s) or (), strict=False):
        yield relative(f"rolling_radius_{side}", radius, axle.rolling_radius)
    yield from slip_of_v(vehicle, s)
    yield from lost_pulses(log, s)


def of_pressure(s: Signals) -> Iterator[Measured]:
    """Pressure of the car that rolls without braking [bar]."""
    if s.lead_in.any():
        zero = max((float(np.mean(p[s.lead_in])) for p in (s.p_f, s.p_r)), key=abs)
        yield Measured("pressure_zero", from_si(zero, "bar", "Pa"))


def of_accelerometer(sensor: Accelerometer) -> Iterator[Measured]:
    """Scale, slope, offset, drag and delay as known at the end of the run."""
    at = sensor.at(-1)
    scale, other = float(at.scale), float(at.other_scale)
    if other != 0.0:
        yield Measured("v_scale", other / (1.0 - other))
    else:
        yield Measured("a_x_scale", scale / (1.0 - scale), math.sqrt(at.variance_scale))
    if at.wanders > LIKELY:
        yield Measured("a_x_against_v", float(at.disagrees))
    yield Measured("a_x_offset", -G * float(at.bias), G * math.sqrt(at.variance_bias))
    yield Measured("unexplained_drag", G * float(at.drag))
    yield Measured("a_x_late", float(at.lag), math.sqrt(at.variance_lag))


def of_brakes(
    response: BrakeResponse | None, odds: float = Vehicle.motor_odds
) -> Iterator[Measured]:
    """Force without pressure, a step of it, and delay; ``odds`` of a motor as in `motor_of`."""
    if response is None:
        return
    chance, share = motor_of(response, odds)
    if chance > MOTOR_LIKELY:
        yield Measured("unexplained_braking_force", share)
    yield Measured("braking_force_missing", response.share, response.share_sigma)
    at, step, scatter = response.step
    yield Measured("force_step", step, scatter, words={"at": at})
    yield Measured("pressure_lag", response.delay, response.delay_sigma)
