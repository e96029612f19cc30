"""Noise of each sensor, and the weight of a sample of the lead-in by its age.

    r  noise density of eta or slip [s^0.5]      a mean over T has the standard deviation r/sqrt(T)
    q  random walk of the zero [1/s^0.5]         the zero walks by q sqrt(T) over T
    tau = r/q [s]                                steady gain of the Kalman filter: 1/tau

The zero of eta or slip is the mean of its lead-in. Rolling radii walk, so the last seconds before
the bite count most: the steady filter weighs by exp(-age/tau) and has the variance r^2/tau = r q,
half noise and half walk (Simon, Optimal State Estimation, section 7.1). Over a lead-in much shorter
than tau the weights are equal.
"""

from dataclasses import dataclass, fields

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.names import AXLES
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.blocks import Blocks
from calib.run.filters import block_mean, samples_in

# lower bounds of the noise densities: no sensor on a car is better, but a simulation may be
_NOISE_FLOOR = {"omega": 3e-4, "z": 1e-4, "v": 3e-4}
_GROUP = 0.2  # length of the means in which the correlation of noise is seen [s]


@dataclass(frozen=True)
class SensorNoise:
    """Noise of the sensors: its density over long times, and that of the wheels between samples."""

    omega: float  # density of the mean wheel speed of an axle [rad/s s^0.5]
    z: float  # density of the deceleration [s^0.5]
    v: float  # density of the reference speed [m/s s^0.5]
    omega_white: float  # standard deviation of the white part of ``omega`` [rad/s]


def worst_noise(noises: list[SensorNoise]) -> SensorNoise:
    """Return the largest of each noise: an estimator must not promise more than the worst run."""
    largest = {f.name: max(getattr(n, f.name) for n in noises) for f in fields(SensorNoise)}
    return SensorNoise(**largest)


def sensor_noise(log: Log, b: Blocks) -> SensorNoise:
    """Estimate the noise of the sensors from the whole run."""
    step, moving = b.length, b.speed > MOVING
    halves = _half_differences(log)
    omega = [_long_run_density(block_mean(x, b.samples)[moving], step) for x in halves]
    v = 0.0 if b.v is None else _long_run_density(b.v[moving], step, b.omega_r[moving], 2.0)
    return SensorNoise(
        omega=max(_rms(omega), _NOISE_FLOOR["omega"]),
        z=max(_long_run_density(b.z[moving], step, b.p_f[moving]), _NOISE_FLOOR["z"]),
        v=max(v, _NOISE_FLOOR["v"]),
        omega_white=_rms([_white_sigma(x) for x in halves]),
    )


def _half_differences(log: Log) -> list[Array]:
    """Half of left less right wheel speed, by axle: the noise of their mean without the motion."""
    return [0.5 * (log[f"omega_{a}l"] - log[f"omega_{a}r"]) for a in AXLES]


def _white_sigma(x: Array) -> float:
    """Standard deviation of the white noise of ``x`` (n,), from its first differences."""
    return float(np.std(np.diff(x)) / np.sqrt(2.0))


def _rms(x: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


_COLOUR = {"omega": 1.5, "z": 2.0, "v": 1.0}
"""Assumed ratio of long-run to white noise if a run is too short to measure it [1]. The available
logs have 0.8 to 2.5 for omega, 1.5 to 4 for z (both from road excitation), and 1 for v."""
_FEW = 10  # samples of a lead-in that are too few: a third of the estimates are 25 % off


def lead_in_noise(log: Log, s: Signals) -> SensorNoise:
    """Estimate the noise from the lead-in, as an ECU can: white noise times `_COLOUR`, or 0."""
    if np.count_nonzero(s.lead_in) <= _FEW:
        return SensorNoise(0.0, 0.0, 0.0, 0.0)
    omega = _rms([_white_sigma(x[s.lead_in]) for x in _half_differences(log)])
    root = np.sqrt(s.sample_time)
    return SensorNoise(
        omega=_COLOUR["omega"] * omega * root,
        z=_COLOUR["z"] * _white_sigma(s.z[s.lead_in]) * root,
        v=0.0 if s.v is None else _COLOUR["v"] * _white_sigma(s.v[s.lead_in]) * root,
        omega_white=omega,
    )


def _long_run_density(
    x: Array, step: float, companion: Array | None = None, window: float = 4.0
) -> float:
    """Noise density over long times [unit s^0.5] of block means ``x`` taken every ``step`` [s].

    Blocks are averaged to groups of `_GROUP` [s]. In each ``window`` [s] the motion of the car is
    subtracted: a parabola and the ``companion``, a signal with the same motion. The residual is
    taken as an AR(1) process. With its coefficient a, corrected for the fitted degrees of freedom
    and not below 0, long means scatter by sqrt((1 + a)/(1 - a)) more than those of white noise.
    Noise with a time constant of 0.1 s comes out 10 % too low, 30 % with a ``window`` of 2 s
    (tests/run/test_noise.py). With fewer than 8 groups the noise is taken as white.
    """
    per_group = samples_in(_GROUP, step)
    groups, group_time = x.size // per_group, step * per_group
    length = min(max(8, round(window / group_time)), groups)  # of a window [groups]
    windows = groups // length if length >= 8 else 0
    if windows == 0:
        return float(np.std(x) * np.sqrt(group_time / per_group))

    def by_window(blocks: Array) -> Array:  # group means, (windows, length)
        return block_mean(blocks, per_group)[: windows * length].reshape(windows, length)

    y = by_window(x)
    t = np.broadcast_to(np.linspace(-1.0, 1.0, length), (windows, length))
    regressors = [np.ones_like(t), t, t**2]
    if companion is not None:
        regressors.append(by_window(companion))
    basis, _ = np.linalg.qr(np.stack(regressors, axis=-1))  # (w = windows, l = length, k)
    residual = y - np.einsum("wlk,wk->wl", basis, np.einsum("wlk,wl->wk", basis, y))
    fitted = len(regressors)
    total = float(np.sum(residual**2))
    if total == 0.0:
        return 0.0
    # the median leaves out the window of the brake application, but the coefficient a counts it, so
    # the density may be too high by up to a factor of 3
    variance = float(np.median(np.sum(residual**2, axis=1))) / (length - fitted)
    lagged = float(np.sum(residual[:, 1:] * residual[:, :-1]))
    a = lagged / total * length / (length - 1) + fitted / length
    a = min(max(a, 0.0), 0.8)
    return float(np.sqrt(variance * group_time * (1.0 + a) / (1.0 - a)))


WALK = 1.2e-5
"""Random walk q of the zeros, by rolling radii that change [1/s^0.5]. A tyre that warms by 30 K in
five minutes gains 0.1 % of radius, 3e-6 a second. With r = 4e-5 s^0.5 of usual wheel speeds tau is
3 s: the zero lags by 1e-5 and has noise of 2e-5. A q that makes 0.1 % in five minutes would forget
a lead-in within a second: over seconds a warming tyre is steadier than a walk."""
_OLDEST = 12.0  # age over tau from which a sample has no weight instead of exp(-12) = 6e-6


def sigma_growth(time: Array, rolling: Mask, density: Array) -> Array:
    """Factor (n,) on the sigma of samples of the lead-in, ``rolling`` (n,), by their age.

    It is exp(age/(2 tau)), so that weights, 1/sigma^2, are exp(-age/tau); outside the lead-in it is
    1, from `_OLDEST` on infinite. ``time`` [s] and ``density`` r [s^0.5] are (n,).
    """
    if not rolling.any():
        return np.ones_like(time)
    age = (time[rolling][-1] - time) * WALK / density  # over tau
    factor = np.exp(0.5 * np.clip(age, 0.0, _OLDEST))
    return np.where(rolling, np.where(age > _OLDEST, np.inf, factor), 1.0)
