"""Delay of the deceleration after the pressure, and the share of it that the pressure explains.

    z(t) = a + (b + c t) p + f min(p, 1.5 bar) + g min(p, 3 bar) + d T_drive(t) + residual
                                           with p at the time t - delay

a is resistance and bias of a_x, b the pads, c their fade or drying, d a motor; f and g are pads
that bite late or a motor that brakes along. On a slow ramp f, g and the delay are nearly collinear,
so f and g have a narrow prior. The delay has a Cauchy prior: brakes are fast, but two clocks may
differ by anything. For each delay of `_TRIED` the other unknowns are found by least squares.

The lead-in and the braking are used. Before the log the pressure is that of the first sample, after
the log it is unknown. Wrong where a wheel is at its limit, and where the torque of a motor looks
like the pressure at another time.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import AXLES, WHEELS, G
from calib.base.warning import LIMITS
from calib.car.braking import BITE
from calib.logs.clock import step_of
from calib.logs.log import Log
from calib.run.axle_signals import axle_pressure
from calib.run.driving_record import BITE_Z, DRIVEN_Z, GREATEST_Z, DrivingRecord, is_rolling
from calib.run.filters import (
    centred_mean,
    inner_products,
    long_run_variance,
    residual_squares,
    samples_in,
    time_since,
)

_TRIED = np.linspace(-4.0, 4.0, 161)  # delays that are tried [s]: clocks may differ by seconds
_USUAL, _SPREAD = 0.02, 0.06
"""Median and half width of the Cauchy prior of the delay [s], whose tails allow a second."""
_SURE = 0.98  # probability that the delay is above `low`, and that it is below `high` [1]
_IN_TIME = 0.6  # longest delay of brakes [s]: a diagnosis looks for lags and delays of up to 0.5 s
_KEPT, _BRAKED = 0.5, 0.25  # least shares of all and of braked rows with a known pressure [1]
_SLOWS = 1.5 * BITE_Z  # deceleration that only a brake makes [g]: an engine in low gear makes less
_BITES = (1.0, 2.0)  # pressures up to which f and g act, over `BITE` [1]
_FORCE = 0.05  # prior sigma of f and of g, at these pressures, over the usual deceleration [1]
_EXACT = 1e-10  # square of the rounding error of z [1]
_GROUPS = (4, 8)  # rows, 0.05 s apart, over which residuals are averaged to see their correlation


@dataclass(frozen=True)
class PressureDelay:
    """Time by which the deceleration comes after the pressure [s], negative where p is late."""

    value: float  # median
    low: float  # 2 % quantile
    high: float  # 98 % quantile
    explained: float  # share of the variance of z that the pressure explains [1]
    explained_in_time: float  # the same with the best delay that brakes may have [1]

    @property
    def nearest_to_zero(self) -> float:
        """Delay nearest to zero in the interval [s]; 0 if the pressure explains too little."""
        trusted = self.explained > LIMITS.explained_late
        return min(max(0.0, self.low), self.high) if trusted else 0.0

    @property
    def words(self) -> str:
        """Text that says how late or early the pressure is."""
        return f"{abs(self.value):.2f} s {'late' if self.value < 0.0 else 'early'}"

    @property
    def entry(self) -> str:
        """Line of a channel map that corrects the delay."""
        return f'delay = "{-self.value:.2f} s"'


def delays_of(log: Log, driving: DrivingRecord, limit: float) -> dict[str, PressureDelay]:
    """Delay of z after the pressures, by channel; one delay for all channels.

    The log is used up to the ``limit`` [s], the first deep slip. If both wheel pressures of an axle
    are logged, wheel pressures count instead of ``p_mc``, which does not show a motor, booster or
    hold; an axle without them keeps ``p_mc``.
    """
    channels, pressures = ["p_mc"], [log["p_mc"]]
    if wheels := [f"p_{w}" for w in WHEELS if f"p_{w[0]}l" in log and f"p_{w[0]}r" in log]:
        channels, pressures = wheels, [axle_pressure(log, axle) for axle in AXLES]
    drives = [log[name] for name in ("T_drive_f", "T_drive_r") if name in log]
    use = driving.moving & (log.time < limit) & (np.abs(log["a_x"]) <= GREATEST_Z * G)
    delay = pressure_delay(log.time, driving.z, pressures, drives, use)
    return {} if delay is None else dict.fromkeys(channels, delay)


def pressure_delay(
    time: Array, z: Array, pressures: Sequence[Array], drives: Sequence[Array], use: Mask
) -> PressureDelay | None:
    """Estimate the delay of ``z`` [1] after ``pressures`` [Pa]; None with too little braking.

    ``pressures`` are ``p_mc`` alone or those of both axles; ``drives`` torques of engine or motor
    [N m]. ``use`` (n,) is true where the car moves, no wheel is at its limit yet and z is valid.
    """
    step, count = step_of(time), len(pressures)
    time, use, (z, *means) = _means(time, use, z, *pressures, *drives)
    use = use & (z > -DRIVEN_Z)
    bites, torques = [p / BITE for p in means[:count]], means[count:]
    slowed = z > _SLOWS
    active = (np.max(bites, axis=0) > 1.0) | slowed
    rolling = ~np.logical_or.accumulate(slowed) & is_rolling(z)  # until z rises: p may be early
    braked, rolled = (step * np.count_nonzero(use & part) for part in (active, rolling))
    if braked < LIMITS.pressure_braked or rolled < LIMITS.pressure_lead_in:
        return None
    rows = np.flatnonzero(use & (rolling | (time_since(time, active) < LIMITS.pressure_after)))
    rows = rows[:: samples_in(LIMITS.pressure_every, step)]
    usual = abs(float(np.median(z[use & active])))
    tried, inside, p = _shifted(time, bites, rows, slowed[rows])
    drifting = (time[rows] - time[rows[0]]) * p
    at_bite = [np.clip(np.max(p, axis=0) / bite, 0.0, 1.0) for bite in _BITES]
    # factors of a; of d, each (n,); of b, c, f and g, each (m, n) as they depend on the delay
    terms = (1.0, *(x[rows] for x in torques), *p, *drifting, *at_bite)
    columns = np.empty((tried.size, len(terms), rows.size))
    for i, term in enumerate(terms):
        columns[:, i] = term
    beyond = ~inside.all(axis=1)
    columns[beyond] *= inside[beyond, None]
    return _posterior(tried, columns, z[rows], inside, _FORCE * usual)


def _means(time: Array, use: Mask, *signals: Array) -> tuple[Array, Mask, list[Array]]:
    """Means around each sample with a full window: its time, whether all is used, the signals."""
    width = samples_in(LIMITS.pressure_width, step_of(time)) | 1
    inside = slice(width // 2, time.size - width // 2)
    unused, *means = (centred_mean(x, width)[inside] for x in ((~use).astype(float), *signals))
    return time[inside], unused == 0.0, means


def _shifted(
    time: Array, pressures: Sequence[Array], rows: Index, braked: Mask
) -> tuple[Array, Mask, Array]:
    """Delays with enough of p(t - delay) in the log (m,), which of p is in it (m, n), p (k, m, n).

    The times t are those of ``rows`` (n,), ``braked`` or not.
    """
    earlier = time[rows] - _TRIED[:, None]  # (161, n)
    inside = earlier <= time[-1]
    enough = np.count_nonzero(inside & braked, axis=1) >= _BRAKED * np.count_nonzero(braked)
    enough &= np.mean(inside, axis=1) > _KEPT
    shifted = np.array([np.interp(earlier[enough], time, p) for p in pressures])
    return _TRIED[enough], inside[enough], shifted


def _posterior(
    tried: Array, columns: Array, y: Array, inside: Mask, force: float
) -> PressureDelay | None:
    """Posterior of the delay; None where ``y`` (n,) is constant.

    ``columns`` (m, k, n) are those of the regression at each of the delays ``tried`` [s] (m,), 0
    where p is not known, that is not ``inside`` (m, n); ``force`` is the prior sigma of f and g.
    """
    if not np.ptp(y) > _EXACT**0.5:  # the sensor is stuck
        return None
    samples, variance = inside.sum(axis=1), float(np.var(y))
    gram, right_side, _ = inner_products(columns, y)
    products = gram, right_side, inside @ y**2
    ridge = np.zeros(columns.shape[1])
    for _ in range(2):  # the first pass gives the noise, which the weight of the prior needs
        squares = residual_squares(products, ridge) / samples + _EXACT
        cost = samples * np.log(squares / variance)  # of white noise, -2 times the log-likelihood
        best = int(np.argmin(cost))
        count = samples[best]  # p is known in the first rows: only the last may be after the log
        A, y_inside = columns[best, :, :count].T, y[:count]
        residual = y_inside - A @ np.linalg.lstsq(A, y_inside, rcond=None)[0]
        smallest = squares[best]
        noise = max(long_run_variance(residual, size) for size in _GROUPS) + _EXACT
        ridge[-len(_BITES) :] = noise / force**2
    log_likelihood = -0.5 * cost * smallest / noise  # correlated residuals count for less
    log_posterior = log_likelihood - np.log1p(((tried - _USUAL) / _SPREAD) ** 2)
    chance = np.exp(log_posterior - np.max(log_posterior))
    chance /= np.sum(chance)
    quantiles = np.cumsum(chance) - 0.5 * chance
    value, low, high = np.interp([0.5, 1.0 - _SURE, _SURE], quantiles, tried).tolist()
    in_time = float(np.min(squares[np.abs(tried) <= _IN_TIME]))
    shares = 1.0 - float(smallest) / variance, 1.0 - in_time / variance
    return PressureDelay(value, low, high, *shares)
