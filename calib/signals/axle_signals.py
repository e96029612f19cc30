r"""From a log to clean signals on one clock.

    log --> axle means, z --> blocks of 50 ms (causal: a block is known when it has passed)
                         \-> lead-in: the unbraked part in front of the first braking
                          \-> noise: what each sensor adds, colour included

Wheel speeds of an axle are averaged left and right: steering and road crown cancel to first order.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import LogError
from calib.logs.log import Log
from calib.physics.forces import deceleration
from calib.physics.vehicle import Vehicle
from calib.signals.driving_record import BITE, MOVING, SETTLE, STEADY

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BLOCK = 0.05
"""Length of a block [s]: ten samples at 200 Hz, short against a brake application (0.2 s)."""


NOISE_FLOOR = {"omega": 3e-4, "z": 1e-4, "v": 3e-4}
"""Least noise densities believed: no sensor on a car is better, a simulation may be."""


@dataclass(frozen=True)
class Signals:
    """Axle signals at the log's own rate, shapes (n,), SI.

    ``p_f``, ``p_r`` axle pressures (wheel pressures where logged, else master cylinder); ``z`` (5);
    ``omega_f``, ``omega_r`` axle means; ``v`` reference speed or None; ``speed`` v, else what the
    rear wheels say. ``lead_in`` is true where the car is not yet braked; ``sample_time`` [s].
    """

    time: Array
    p_f: Array
    p_r: Array
    z: Array
    omega_f: Array
    omega_r: Array
    v: Array | None
    speed: Array
    lead_in: Mask
    sample_time: float


@dataclass(frozen=True)
class Blocks:
    """Means over blocks, shapes (k,), SI; ``end`` is the time at which a block is complete.

    ``spin_f``, ``spin_r`` are d omega/dt from one block to the next (causal); ``samples`` in each.
    """

    end: Array
    p_f: Array
    p_r: Array
    z: Array
    omega_f: Array
    omega_r: Array
    v: Array | None
    speed: Array
    spin_f: Array
    spin_r: Array
    lead_in: Mask
    samples: int
    length: float

    @property
    def eta(self) -> Array:
        """Eta of (22), not zeroed [1]; 1 where the front wheels stand."""
        return eta_of(self.omega_f, self.omega_r)


@dataclass(frozen=True)
class SensorNoise:
    """What the sensors add: long-run density, so that a mean over T has sd density/sqrt(T).

    ``omega`` [rad/s s^0.5] of one axle mean; ``z`` [s^0.5]; ``v`` [m/s s^0.5]; ``omega_white``
    [rad/s] the sample-to-sample part of one axle mean.
    """

    omega: float
    z: float
    v: float
    omega_white: float


def eta_of(omega_f: Array, omega_r: Array) -> Array:
    """omega_r/omega_f of (22) [1]; 1 where the front wheels stand, so that no slip shows."""
    return np.divide(omega_r, omega_f, out=np.ones_like(omega_f), where=omega_f > 0.0)


def signals(log: Log, vehicle: Vehicle) -> Signals:
    """Axle signals of a log. Raises LogError if the car hardly moves."""
    omega_f = 0.5 * (log["omega_fl"] + log["omega_fr"])
    omega_r = 0.5 * (log["omega_rl"] + log["omega_rr"])
    p_f, p_r = _axle_pressure(log, "f"), _axle_pressure(log, "r")
    v = log.channels.get("v")
    speed = vehicle.rear.rolling_radius * omega_r if v is None else v
    if np.max(speed) < MOVING:
        raise LogError(
            f"the car hardly moves: at most {np.max(speed):.1f} m/s",
            where=log.source,
            expected="a braking from more than 8 m/s",
        )
    z = deceleration(log["a_x"])
    return Signals(
        time=log.time,
        p_f=p_f,
        p_r=p_r,
        z=z,
        omega_f=omega_f,
        omega_r=omega_r,
        v=v,
        speed=speed,
        lead_in=lead_in(log.time, np.maximum(p_f, p_r), z, speed, log.sample_time),
        sample_time=log.sample_time,
    )


def _axle_pressure(log: Log, axle: str) -> Array:
    """Mean of both wheel pressures [Pa] where both are logged, else the master cylinder's."""
    left, right = f"p_{axle}l", f"p_{axle}r"
    if left in log and right in log:
        return 0.5 * (log[left] + log[right])
    return log["p_mc"]


def lead_in(time: Array, pressure: Array, z: Array, speed: Array, step: float) -> Mask:
    """Samples of steady rolling before the first braking, less ``SETTLE``; all if there is none.

    An engine that pulls hard makes the driven wheels slip, so that eta is no zero there. ``step``
    is the sample time [s].
    """
    smooth = trailing_mean(pressure, max(1, round(0.05 / step)))
    braked = np.flatnonzero(smooth > BITE)
    first = time[braked[0]] - SETTLE - 0.05 if braked.size else np.inf
    steady = np.abs(trailing_mean(z, max(1, round(0.1 / step)))) < STEADY
    return np.asarray((time < first) & steady & (speed > MOVING))


def trailing_mean(x: Array, n: int) -> Array:
    """Mean of the last n samples; of those there are, at the start."""
    total = np.cumsum(np.concatenate([[0.0], x]))
    stop = np.arange(1, x.size + 1)
    start = np.maximum(stop - n, 0)
    return np.asarray((total[stop] - total[start]) / (stop - start))


def blocks(s: Signals, length: float = BLOCK) -> Blocks:
    """Means over consecutive blocks of about ``length`` [s]; a shorter rest is dropped."""
    n = max(1, round(length / s.sample_time))
    count = s.time.size // n

    def mean(x: Array) -> Array:
        return np.asarray(x[: count * n].reshape(count, n).mean(axis=1))

    omega_f, omega_r = mean(s.omega_f), mean(s.omega_r)
    end = s.time[n - 1 : count * n : n]
    step = n * s.sample_time
    return Blocks(
        end=end,
        p_f=mean(s.p_f),
        p_r=mean(s.p_r),
        z=mean(s.z),
        omega_f=omega_f,
        omega_r=omega_r,
        v=None if s.v is None else mean(s.v),
        speed=mean(s.speed),
        spin_f=np.diff(omega_f, prepend=omega_f[0]) / step,
        spin_r=np.diff(omega_r, prepend=omega_r[0]) / step,
        lead_in=s.lead_in[n - 1 : count * n : n],
        samples=n,
        length=step,
    )


def sensor_noise(log: Log, b: Blocks) -> SensorNoise:
    """Noise of the sensors, from the whole run.

    Left minus right wheel speed holds the sensors' noise and no common motion; its mean square over
    four is that of the axle mean. ``z`` is compared with the pressure, ``v`` with the wheels.
    """
    n, step = b.samples, b.length
    count = b.end.size
    moving = b.speed > MOVING
    halves = [0.5 * (log[f"omega_{a}l"] - log[f"omega_{a}r"]) for a in "fr"]
    means = [h[: count * n].reshape(count, n).mean(axis=1)[moving] for h in halves]
    omega = [long_run_density(m, step) for m in means]
    white = [float(np.std(np.diff(h)) / np.sqrt(2.0)) for h in halves]
    v = 0.0 if b.v is None else long_run_density(b.v[moving], step, b.omega_r[moving], 2.0)
    return SensorNoise(
        omega=max(float(np.sqrt(np.mean(np.square(omega)))), NOISE_FLOOR["omega"]),
        z=max(long_run_density(b.z[moving], step, b.p_f[moving]), NOISE_FLOOR["z"]),
        v=max(v, NOISE_FLOOR["v"]),
        omega_white=float(np.sqrt(np.mean(np.square(white)))),
    )


COLOUR = {"omega": 1.5, "z": 2.0, "v": 1.0}
"""Long-run over white noise that is assumed where a run is too short to tell: road-shaken wheels
and bodies, an unshaken receiver. The logs at hand lie between 0.8 and 2.5, 1.5 and 4, and at 1."""


def lead_in_noise(log: Log, s: Signals) -> SensorNoise:
    """Noise of the sensors as far as the lead-in shows it: its white part and a usual colour.

    Uses nothing after the lead-in, so that an estimator may use it.
    """
    step = np.sqrt(s.sample_time)

    def white(x: Array) -> float:
        return float(np.std(np.diff(x[s.lead_in])) / np.sqrt(2.0))

    pairs = [0.5 * (log[f"omega_{a}l"] - log[f"omega_{a}r"]) for a in "fr"]
    omega = float(np.sqrt(np.mean([white(pair) ** 2 for pair in pairs])))
    return SensorNoise(
        omega=COLOUR["omega"] * omega * step,
        z=COLOUR["z"] * white(s.z) * step,
        v=0.0 if s.v is None else COLOUR["v"] * white(s.v) * step,
        omega_white=omega,
    )


def long_run_density(
    x: Array, step: float, companion: Array | None = None, window: float = 4.0, group: float = 0.2
) -> float:
    """Long-run noise density [unit s^0.5] of block means ``x`` taken every ``step`` [s].

    Blocks are averaged to ``group`` [s]. In each ``window`` [s] a parabola and the ``companion``
    signal are taken out; what is left is read as an AR(1) process, whose long-run standard
    deviation is sd sqrt((1 + r)/(1 - r)). r is corrected for the degrees of freedom taken out and
    kept at 0 or above: a negative colour (a tooth-timing sensor) promises more than a short stop
    can hold. On noise with a time constant of 0.1 s it reads about 10 % low, and 30 % low with a
    ``window`` of 2 s, where parabola and companion take much of it
    (tests/signals/test_axle_signals.py). Below 8 groups nothing is taken out and the noise is read
    as white.
    """
    per_group = max(1, round(group / step))
    groups = x.size // per_group
    step *= per_group
    length = min(max(8, round(window / step)), groups)
    windows = groups // length if length >= 8 else 0
    if windows == 0:
        return float(np.std(x) * np.sqrt(step / per_group))

    def rows(values: Array) -> Array:
        means = values[: groups * per_group].reshape(groups, per_group).mean(axis=1)
        return np.asarray(means[: windows * length].reshape(windows, length))

    t = np.broadcast_to(np.linspace(-1.0, 1.0, length), (windows, length))
    regressors = [np.ones_like(t), t, t**2]
    if companion is not None:
        regressors.append(rows(companion))
    basis, _ = np.linalg.qr(np.stack(regressors, axis=-1))
    y = rows(x)
    residual = y - np.einsum("wlk,wk->wl", basis, np.einsum("wlk,wl->wk", basis, y))
    taken = len(regressors)
    total = float(np.sum(residual**2))
    if total == 0.0:
        return 0.0
    # the median keeps the window in which the brake bites out of the variance, not out of r: a
    # violent bite reads up to 3 times high
    variance = float(np.median(np.sum(residual**2, axis=1))) / (length - taken)
    lagged = float(np.sum(residual[:, 1:] * residual[:, :-1]))
    r = lagged / total * length / (length - 1) + taken / length
    r = min(max(r, 0.0), 0.8)
    return float(np.sqrt(variance * step * (1.0 + r) / (1.0 - r)))
