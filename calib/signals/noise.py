"""What each sensor adds to its signal, colour included."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.logs.log import Log
from calib.physics.braking import MOVING
from calib.signals.axle_signals import Signals
from calib.signals.blocks import Blocks
from calib.signals.filters import block_mean

Array = NDArray[np.float64]

NOISE_FLOOR = {"omega": 3e-4, "z": 1e-4, "v": 3e-4}
"""Least noise densities believed: no sensor on a car is better, a simulation may be."""


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


def sensor_noise(log: Log, b: Blocks) -> SensorNoise:
    """Noise of the sensors, from the whole run.

    Left minus right wheel speed holds the sensors' noise and no common motion; its mean square over
    four is that of the axle mean. ``z`` is compared with the pressure, ``v`` with the wheels.
    """
    n, step = b.samples, b.length
    moving = b.speed > MOVING
    halves = [0.5 * (log[f"omega_{a}l"] - log[f"omega_{a}r"]) for a in "fr"]
    means = [block_mean(h, n)[moving] for h in halves]
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
        means = block_mean(values, per_group)
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
