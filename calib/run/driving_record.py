r"""Approximate motion of the car in a run: speed, deceleration, brake events.

It needs no vehicle file.

    p_mc   ___/~~~~\_____/~~\__
              |    |     |  |
              +-event   +-event
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import WHEELS, G
from calib.base.warning import LIMITS
from calib.car.braking import BITE, MOVING
from calib.logs.clock import GAP, step_of
from calib.logs.log import Log
from calib.run.filters import block_mean, centred_mean, runs, samples_in

BITE_Z = 0.08  # least braking if no pressure is logged [g]: above drag and engine
STEADY = 0.15  # largest deceleration of a car that rolls [g]
DRIVEN = 0.05
"""Felt acceleration [g] of no rolling car, since a slope is not felt, and beyond the bias of an
accelerometer: the engine drives, and the slip of its wheels shows in eta."""
GREATEST = 1.5  # deceleration that no road car reaches [g]: a glitch of a_x
_SHORTEST, _PAUSE = 0.3, 0.2  # shortest brake event, and shortest release that ends one [s]
_STROKE = 0.25  # means by which a rise is judged [s]: over pedal tremble, below a ramp
SETTLE = 0.1  # left out between lead-in and first event [s]: pressure rises before the bite
SMOOTH = 0.1  # width of the centred mean that reduces the noise [s]
NOMINAL_RADIUS = 0.32  # rolling radius of a usual wheel [m], for a speed if ``v`` is not logged


def rolls(z: Array) -> Mask:
    """Whether a smoothed felt deceleration (n,) [g] is that of a rolling car."""
    return np.asarray((z > -DRIVEN) & (z < STEADY))


@dataclass(frozen=True)
class DrivingRecord:
    """Smoothed signals of a run, shapes (n,), SI.

    ``wheel`` mean of the four wheel speeds; ``speed`` reference speed, else that of the wheels at
    a nominal radius; ``z`` by ``a_x``, ``wheel_z`` by the wheels at that radius [1].
    """

    time: Array
    step: float
    wheel: Array
    speed: Array
    z: Array
    wheel_z: Array
    pressure: Array | None
    braked: Mask
    before_braking: Mask

    @cached_property
    def moving(self) -> Mask:
        """Mask (n,): the car is fast enough to be judged."""
        return self.speed > MOVING

    @cached_property
    def unbraked(self) -> Mask:
        """Mask (n,): steady motion before the first braking; all of it if that is too short."""
        steady = ~self.braked & self.moving & rolls(self.z)
        first = self.before_braking & steady
        return first if first.sum() * self.step >= 0.5 else steady


@dataclass(frozen=True)
class BrakeEvent:
    """One application of the brakes, times in s, speeds in m/s; ``first`` is a sample number.

    ``pressure`` highest [Pa] or None; ``z_low`` to ``z_high`` [1]; ``braking`` time above 3 m/s;
    ``rise`` length of the longest steady rise and ``rise_z`` its range of deceleration [1].
    """

    start: float
    end: float
    first: int
    pressure: float | None
    z_low: float
    z_high: float
    speed_start: float
    speed_end: float
    braking: float
    rise: float
    rise_z: float


def driving_record(log: Log) -> DrivingRecord:
    """Approximate motion. The log must have ``time``, ``a_x`` and the four wheel speeds."""
    time, step = log.time, log.sample_time
    width = samples_in(SMOOTH, step) | 1
    wheel = centred_mean(np.mean([log[f"omega_{w}"] for w in WHEELS], axis=0), width)
    speed = centred_mean(log["v"], width) if "v" in log else NOMINAL_RADIUS * wheel
    z = centred_mean(-log["a_x"] / G, width)
    pressure = centred_mean(log["p_mc"], width) if "p_mc" in log else None
    active = pressure > BITE if pressure is not None else (z > BITE_Z) & (speed > 0.5)
    # short pauses are closed, short applications dropped
    braked = np.array(active)
    for start, end in runs(~braked):
        braked[start:end] = start > 0 and end < time.size and (end - start) * step < _PAUSE
    for start, end in runs(braked):
        braked[start:end] = (end - start) * step >= _SHORTEST
    first = np.argmax(braked) - round(SETTLE / step) if braked.any() else time.size
    rolls_first = np.arange(time.size) < first
    wheel_z = -NOMINAL_RADIUS / G * centred_mean(np.gradient(wheel, time), width)
    return DrivingRecord(time, step, wheel, speed, z, wheel_z, pressure, braked, rolls_first)


def brake_events(driving: DrivingRecord) -> tuple[BrakeEvent, ...]:
    """The applications of the brake, in order of time."""
    return tuple(_event(driving, slice(start, end)) for start, end in runs(driving.braked))


def _event(driving: DrivingRecord, part: slice) -> BrakeEvent:
    time, speed, moving = driving.time[part], driving.speed[part], driving.moving[part]
    z = driving.z[part][moving] if moving.any() else driving.z[part]
    pressure = None if driving.pressure is None else float(driving.pressure[part].max())
    rise, rise_z = _steady_rise(driving, part)
    return BrakeEvent(
        start=float(time[0]),
        end=float(time[-1]),
        first=part.start,
        pressure=pressure,
        z_low=float(z.min()),
        z_high=float(z.max()),
        speed_start=float(speed[0]),
        speed_end=float(speed[-1]),
        braking=float(moving.sum() * driving.step),
        rise=rise,
        rise_z=rise_z,
    )


def _steady_rise(driving: DrivingRecord, part: slice) -> tuple[float, float]:
    """Length [s] and span [g] of the longest steady rise in an event.

    In it means of the pressure (else of z) over `_STROKE` never fall by more than 5 % of their
    range. It counts from 5 to 95 % of its range, so that a step and a long hold are short.
    """
    moving = driving.moving[part]
    drive = driving.z[part] if driving.pressure is None else driving.pressure[part]
    drive, z = drive[moving], driving.z[part][moving]
    n = samples_in(_STROKE, driving.step)
    if drive.size < 2 * n:
        return 0.0, 0.0
    best = (0.0, 0.0)
    strokes = block_mean(drive, n)
    falls = np.diff(strokes) < -0.05 * np.ptp(strokes)
    for a, b in runs(np.concatenate([[True], ~falls])):
        first = max(a - 1, 0)
        stretch = drive[first * n : b * n]
        low, high = stretch[0], stretch.max()
        begin = int(np.flatnonzero(stretch <= low + 0.05 * (high - low))[-1])
        end = int(np.argmax(stretch >= low + 0.95 * (high - low)))
        if end > begin:
            part_z = z[first * n + begin : first * n + end + 1]
            best = max(best, (float((end - begin) * driving.step), float(np.ptp(part_z))))
    return best


@dataclass(frozen=True)
class Sampling:
    """Clock of a log: ``duration`` [s], mean ``rate`` [Hz], ``gaps`` as (start [s], length [s]).

    ``jitter`` root mean square deviation of the steps from their mean, without gaps [s].
    """

    samples: int
    duration: float
    rate: float
    jitter: float
    gaps: tuple[tuple[float, float], ...]


def sampling_of(time: Array) -> Sampling:
    """Sampling of a strictly increasing time [s], shape (n,)."""
    steps, step = np.diff(time), step_of(time)
    wide = steps > GAP * step
    jitter = steps[~wide] - step
    return Sampling(
        samples=time.size,
        duration=float(time[-1] - time[0]),
        rate=1.0 / step,
        jitter=float(np.sqrt(np.mean(jitter**2))),
        gaps=tuple((float(time[i]), float(steps[i])) for i in np.flatnonzero(wide)),
    )


def standing(log: Log) -> Mask:
    """Where no wheel turns (n,)."""
    return np.asarray(np.max([log[f"omega_{w}"] for w in WHEELS], axis=0) < LIMITS.standing)
