r"""Approximate motion of the car in a log, without a vehicle file: speed, deceleration, braking.

    p_mc   ___/~~~~\_____/~~\__
              |    |     |  |
              +-event   +-event

`Sampling` describes the clock of a log.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import WHEELS, G
from calib.car.braking import BITE, MOVING
from calib.logs.clock import GAP, step_of
from calib.logs.log import Log
from calib.run.filters import block_mean, centred_mean, samples_in, true_intervals

BITE_Z = 0.08  # deceleration of a braked car without a logged pressure [g]: above drag and engine
ROLLING_Z = 0.15  # largest deceleration of a car that rolls unbraked [g]
DRIVEN_Z = 0.05
"""Acceleration [g] beyond which the engine drives the car, so that the slip of the driven wheels
shows in eta. A slope is not felt by the accelerometer, and its bias is smaller."""
GREATEST_Z = 1.5  # deceleration that no road car reaches [g]: beyond it a_x has a glitch
_SHORTEST = 0.3  # shortest brake event [s]
_PAUSE = 0.2  # shortest release of the brakes that ends an event [s]
_RISE_MEAN = 0.25  # length of the means by which a rise is judged [s]: a foot trembles faster
SETTLE = 0.1  # time left out between lead-in and first event [s]: pressure rises before the bite
SMOOTHING = 0.1  # width of the centred mean that reduces the noise [s]
NOMINAL_RADIUS = 0.32  # rolling radius of a usual wheel [m], for a speed if ``v`` is not logged


def is_rolling(z: Array) -> Mask:
    """Whether the car rolls, neither braked nor driven, by its smoothed deceleration ``z`` [g]."""
    return np.asarray((z > -DRIVEN_Z) & (z < ROLLING_Z))


@dataclass(frozen=True)
class DrivingRecord:
    """Smoothed signals of a log, shapes (n,), SI."""

    time: Array
    step: float  # sample time
    wheel: Array  # mean of the four wheel speeds
    speed: Array  # v, or if not logged that of the wheels at `NOMINAL_RADIUS`
    z: Array  # deceleration by a_x [1]
    wheel_z: Array  # deceleration by the wheels at `NOMINAL_RADIUS` [1]
    pressure: Array | None
    braked: Mask  # in a brake event
    before_braking: Mask  # until `SETTLE` before the first event

    @cached_property
    def moving(self) -> Mask:
        """Mask (n,) of samples in which the car is fast enough for its slip to be computed."""
        return self.speed > MOVING

    @cached_property
    def unbraked(self) -> Mask:
        """Mask (n,) of unbraked rolling before the first event; in the whole log if under 0.5 s."""
        rolling = ~self.braked & self.moving & is_rolling(self.z)
        lead_in = self.before_braking & rolling
        return lead_in if lead_in.sum() * self.step >= 0.5 else rolling


@dataclass(frozen=True)
class BrakeEvent:
    """One application of the brakes; times in s, speeds in m/s, decelerations in g."""

    start: float
    end: float
    first_sample: int
    pressure: float | None  # highest [Pa]; None if not logged
    z_low: float
    z_high: float
    speed_start: float
    speed_end: float
    braking_time: float  # above `MOVING`
    rise_time: float  # of the longest steady rise
    rise_z: float  # range of the deceleration in that rise


def driving_record(log: Log) -> DrivingRecord:
    """Compute the approximate motion of a log with ``a_x`` and the four wheel speeds."""
    time, step = log.time, log.sample_time
    width = samples_in(SMOOTHING, step) | 1
    wheel = centred_mean(np.mean([log[f"omega_{w}"] for w in WHEELS], axis=0), width)
    speed = centred_mean(log["v"], width) if "v" in log else NOMINAL_RADIUS * wheel
    z = centred_mean(-log["a_x"] / G, width)
    pressure = centred_mean(log["p_mc"], width) if "p_mc" in log else None
    active = pressure > BITE if pressure is not None else (z > BITE_Z) & (speed > 0.5)
    braked = np.array(active)
    # a short release within an event counts as braked, a short application as unbraked
    for start, end in true_intervals(~braked):
        if start > 0 and end < time.size and (end - start) * step < _PAUSE:
            braked[start:end] = True
    for start, end in true_intervals(braked):
        if (end - start) * step < _SHORTEST:
            braked[start:end] = False
    first = np.argmax(braked) - round(SETTLE / step) if braked.any() else time.size
    before_braking = np.arange(time.size) < first
    wheel_z = -NOMINAL_RADIUS / G * centred_mean(np.gradient(wheel, time), width)
    return DrivingRecord(time, step, wheel, speed, z, wheel_z, pressure, braked, before_braking)


def brake_events(driving: DrivingRecord) -> tuple[BrakeEvent, ...]:
    """Return the applications of the brakes in order of time."""
    return tuple(_event(driving, slice(*interval)) for interval in true_intervals(driving.braked))


def _event(driving: DrivingRecord, part: slice) -> BrakeEvent:
    time, speed, moving = driving.time[part], driving.speed[part], driving.moving[part]
    z = driving.z[part][moving] if moving.any() else driving.z[part]
    pressure = None if driving.pressure is None else float(driving.pressure[part].max())
    rise_time, rise_z = _steady_rise(driving, part)
    return BrakeEvent(
        start=float(time[0]),
        end=float(time[-1]),
        first_sample=part.start,
        pressure=pressure,
        z_low=float(z.min()),
        z_high=float(z.max()),
        speed_start=float(speed[0]),
        speed_end=float(speed[-1]),
        braking_time=float(moving.sum() * driving.step),
        rise_time=rise_time,
        rise_z=rise_z,
    )


def _steady_rise(driving: DrivingRecord, part: slice) -> tuple[float, float]:
    """Length [s] and range of z [g] of the longest steady rise in the event ``part``.

    A rise is judged by the pressure, or by z if no pressure is logged. It is steady while its means
    over `_RISE_MEAN` never fall by more than 5 % of their range. Its length counts from 5 to 95 %
    of its height, so that a step followed by a long hold is short.
    """
    moving = driving.moving[part]
    z = driving.z[part][moving]
    x = z if driving.pressure is None else driving.pressure[part][moving]
    n = samples_in(_RISE_MEAN, driving.step)
    if x.size < 2 * n:
        return 0.0, 0.0
    longest = (0.0, 0.0)
    means = block_mean(x, n)
    change = np.diff(means, prepend=means[0])  # of each mean from the mean before
    for first_mean, end_mean in true_intervals(change >= -0.05 * np.ptp(means)):
        start = max(first_mean - 1, 0) * n  # a rise begins in the mean before
        rise = x[start : end_mean * n]
        low, height = rise[0], rise.max() - rise[0]
        begin = int(np.flatnonzero(rise <= low + 0.05 * height)[-1])
        end = int(np.argmax(rise >= low + 0.95 * height))
        if end > begin:
            z_range = float(np.ptp(z[start + begin : start + end + 1]))
            longest = max(longest, (float((end - begin) * driving.step), z_range))
    return longest


@dataclass(frozen=True)
class Sampling:
    """Clock of a log."""

    samples: int
    duration: float  # [s]
    rate: float  # mean [Hz]
    jitter: float  # root mean square deviation of the steps from their mean, without gaps [s]
    gaps: tuple[tuple[float, float], ...]  # start and length of each [s]


def sampling_of(time: Array) -> Sampling:
    """Describe the clock of a strictly increasing time [s], shape (n,)."""
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
