"""Noise of each sensor, white and coloured, and the ageing of the zeros of eta and slip.

    r  noise density of what is zeroed [s^0.5]       a mean over T has sd r/sqrt(T)
    q  random walk of the zero [1/s^0.5]             over T it walks by q sqrt(T)
    tau = r/q                                        steady gain of the Kalman filter: 1/tau

Rolling radii walk, so the last seconds before the bite count most. The steady filter weighs by
exp(-age/tau) and has the variance r^2/tau = r q, half noise and half walk (Simon, Optimal State
Estimation, section 7.1). A lead-in much shorter than tau is a plain mean.
"""

from dataclasses import dataclass, fields

import numpy as np

from calib.base.arrays import Array, Mask
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.blocks import Blocks
from calib.run.filters import block_mean, samples_in

_NOISE_FLOOR = {"omega": 3e-4, "z": 1e-4, "v": 3e-4}
"""Lower bounds of the noise densities: no sensor on a car is better, but a simulation may be."""


@dataclass(frozen=True)
class SensorNoise:
    """Long-run noise density of the sensors: a mean over T [s] has sd density/sqrt(T).

    ``omega`` [rad/s s^0.5] of one axle mean; ``z`` [s^0.5]; ``v`` [m/s s^0.5]; ``omega_white``
    [rad/s] the white part of one axle mean.
    """

    omega: float
    z: float
    v: float
    omega_white: float


def worst_noise(noises: list[SensorNoise]) -> SensorNoise:
    """The largest of each noise: an estimator must not promise more than in the worst run."""
    return SensorNoise(*(max(getattr(n, f.name) for n in noises) for f in fields(SensorNoise)))


def sensor_noise(log: Log, b: Blocks) -> SensorNoise:
    """Noise of the sensors from the whole run.

    Half of left minus right wheel speed has the noise of the axle mean, without motion. The
    pressure explains ``z``, the wheels explain ``v``.
    """
    step, moving = b.length, b.speed > MOVING
    halves = _halves(log)
    omega = [_long_run_density(block_mean(h, b.samples)[moving], step) for h in halves]
    v = 0.0 if b.v is None else _long_run_density(b.v[moving], step, b.omega_r[moving], 2.0)
    return SensorNoise(
        omega=max(_rms(omega), _NOISE_FLOOR["omega"]),
        z=max(_long_run_density(b.z[moving], step, b.p_f[moving]), _NOISE_FLOOR["z"]),
        v=max(v, _NOISE_FLOOR["v"]),
        omega_white=_rms([_white(h) for h in halves]),
    )


def _halves(log: Log) -> list[Array]:
    return [0.5 * (log[f"omega_{a}l"] - log[f"omega_{a}r"]) for a in "fr"]


def _white(x: Array) -> float:
    return float(np.std(np.diff(x)) / np.sqrt(2.0))


def _rms(x: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


_COLOUR = {"omega": 1.5, "z": 2.0, "v": 1.0}
"""Assumed ratio of long-run to white noise if a run is too short to measure it [1]. The available
logs have 0.8 to 2.5 for omega, 1.5 to 4 for z (both from road excitation), and 1 for v."""

_FEW = 10  # samples of a lead-in that show no noise: every second estimate is 25 % off


def lead_in_noise(log: Log, s: Signals) -> SensorNoise:
    """Noise of the sensors from the lead-in alone, for causal use: white part times `_COLOUR`."""
    if np.count_nonzero(s.lead_in) <= _FEW:
        return SensorNoise(0.0, 0.0, 0.0, 0.0)
    omega = _rms([_white(half[s.lead_in]) for half in _halves(log)])
    z, v = (0.0 if x is None else _white(x[s.lead_in]) for x in (s.z, s.v))
    step = np.sqrt(s.sample_time)
    white = {"omega": omega, "z": z, "v": v}
    return SensorNoise(**{n: _COLOUR[n] * x * step for n, x in white.items()}, omega_white=omega)


def _long_run_density(
    x: Array, step: float, companion: Array | None = None, window: float = 4.0, group: float = 0.2
) -> float:
    """Long-run noise density [unit s^0.5] of block means ``x`` taken every ``step`` [s].

    Blocks are averaged to ``group`` [s]. In each ``window`` [s] a parabola and the ``companion``
    signal are subtracted. The residual is an AR(1) process with the long-run standard deviation
    sd sqrt((1 + r)/(1 - r)); r is corrected for the fitted degrees of freedom and not below 0.
    Noise with a time constant of 0.1 s comes out 10 % too low, 30 % with a ``window`` of 2 s
    (tests/run/test_noise.py). Below 8 groups the noise is taken as white.
    """
    per_group = samples_in(group, step)
    groups = x.size // per_group
    step *= per_group
    length = min(max(8, round(window / step)), groups)
    windows = groups // length if length >= 8 else 0
    if windows == 0:
        return float(np.std(x) * np.sqrt(step / per_group))

    t = np.broadcast_to(np.linspace(-1.0, 1.0, length), (windows, length))
    y, *others = (
        block_mean(values, per_group)[: windows * length].reshape(windows, length)
        for values in (x, companion)
        if values is not None
    )
    regressors = [np.ones_like(t), t, t**2, *others]
    basis, _ = np.linalg.qr(np.stack(regressors, axis=-1))
    residual = y - np.einsum("wlk,wk->wl", basis, np.einsum("wlk,wl->wk", basis, y))
    fitted = len(regressors)
    total = float(np.sum(residual**2))
    if total == 0.0:
        return 0.0
    # the median leaves the brake application out of the variance, but r has it: up to 3 times high
    variance = float(np.median(np.sum(residual**2, axis=1))) / (length - fitted)
    lagged = float(np.sum(residual[:, 1:] * residual[:, :-1]))
    r = lagged / total * length / (length - 1) + fitted / length
    r = min(max(r, 0.0), 0.8)
    return float(np.sqrt(variance * step * (1.0 + r) / (1.0 - r)))


WALK = 1.2e-5
"""Random walk q of the ratio of two rolling radii, and of radius to v [1/s^0.5]. A tyre that warms
by 30 K in five minutes gains 0.1 % of radius, 3e-6 a second. With r = 4e-5 of usual wheel speeds
tau is 3 s: the zero lags by 1e-5 and has noise of 2e-5. A q that makes 0.1 % in five minutes would
forget a lead-in within half a second: over seconds a warming tyre is steadier than a walk."""

_OLDEST = 12.0  # age over tau beyond which a sample is forgotten: its weight is 6e-6


def sigma_growth(time: Array, rolling: Mask, density: Array) -> Array:
    """Factor (n,) on the sigma of samples measured while ``rolling`` (n,), by their age.

    ``time`` [s], ``density`` r [s^0.5], (n,). 1 at the end of the rolling and outside it; infinite
    where a sample is forgotten.
    """
    if not rolling.any():
        return np.ones_like(time)
    age = (time[rolling][-1] - time) * WALK / density
    factor = np.exp(0.5 * np.clip(age, 0.0, _OLDEST))
    return np.where(rolling, np.where(age > _OLDEST, np.inf, factor), 1.0)
