"""What a run says against its channels: one signal twice, wheels of another size."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.base.warning import PlausibilityWarning, warning
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.plausibility.limits import PLAUSIBLE
from calib.run.axle_signals import HELD, Signals, held_time, rolling_radii, wheels_held
from calib.run.copies import twice
from calib.run.limits import LIMITS
from calib.run.speed_delay import USUAL, SpeedDelay
from calib.run.warnings import impossible_samples

Array = NDArray[np.float64]


COMPARED = (*(f"omega_{w}" for w in WHEELS), "v", "a_x", "p_mc")


def channel_warnings(log: Log, vehicle: Vehicle, s: Signals) -> Iterator[PlausibilityWarning]:
    """Samples that no car drives, one signal twice, wheels that are not those of the file."""
    yield from impossible_samples(log)
    yield from _twice(log)
    yield from _held(log, s.v is not None or s.delay.late)
    if s.delay.late:
        yield _late(log.name, s.delay)
    yield from _radii(log.name, vehicle, s)


def _twice(log: Log) -> Iterator[PlausibilityWarning]:
    for one, other, same in twice(log, [name for name in COMPARED if name in log]):
        yield PlausibilityWarning(
            "same_signal",
            log.name,
            same,
            (0.0, LIMITS.copy_correlation),
            (f"{other} is a copy of {one}", "a channel map that names one column twice"),
            "record each sensor by itself",
        )


def _held(log: Log, v_used: bool) -> Iterator[PlausibilityWarning]:
    """Channels that keep a value for too long: a v that the signals left out, and wheel speeds."""
    if "v" in log and not v_used:
        yield warning("v_held", log.name, held_time(log), (0.0, HELD))
    longest = wheels_held(log)
    if longest > LIMITS.wheels_held:
        yield warning("wheels_held", log.name, longest, (0.0, LIMITS.wheels_held))


def _late(log: str, delay: SpeedDelay) -> PlausibilityWarning:
    return PlausibilityWarning(
        "v_late",
        log,
        delay.value,
        (0.0, 3.0 * USUAL),
        ("v of a receiver of satellites, or of a slow filter", "the clock of v"),
        ("v was put in time" if delay.sharp else "v is not used") + "; record v without its delay",
    )


def _radii(log: str, vehicle: Vehicle, s: Signals) -> Iterator[PlausibilityWarning]:
    radii = rolling_radii(s)
    if radii is None:
        return
    axles = (("f", vehicle.front), ("r", vehicle.rear))
    for (side, axle), radius in zip(axles, radii, strict=True):
        low, high = ((1.0 + sign * PLAUSIBLE.radius) * axle.rolling_radius for sign in (-1.0, 1.0))
        if not low < radius < high:
            yield warning(f"rolling_radius_{side}", log, radius, (low, high))
