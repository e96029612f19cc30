"""Delay of the deceleration after the pressure, and the share of it that the pressure explains.

    z(t) = a + (b + c t) p + f min(p, 1.5 bar) + g min(p, 3 bar) + d T_drive(t) + residual
                                           with p of t - delay

over the lead-in and the braking, seen by pressure or deceleration. c is fade or drying of the pads,
a is resistance and bias of a_x, f and g are pads that bite late or a motor that brakes along. On a
slow ramp f, g and the delay are nearly collinear, so f and g have a narrow prior. The delay has a
Cauchy prior: brakes are fast, but two clocks may differ by anything. Before the log the pressure is
that of the first sample, after it unknown. Wrong where a wheel is at its limit, and where the
torque of a motor looks like the pressure at another time.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import AXLES, G
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

_TRIED = np.linspace(-4.0, 4.0, 161)  # delays that are tried [s]; two clocks may be anywhere apart
_USUAL, _SPREAD = 0.02, 0.06
"""Median and half width of the Cauchy prior of the delay [s]: brakes and filters are near it, and
its tails allow a delay of a second."""
_SURE = 0.98  # probability that the delay is above `low`, and that it is below `high` [1]
_IN_TIME = 0.6  # longest delay of brakes [s]: a diagnosis looks for lags and delays of up to 0.5 s
_KEPT, _BRAKED = 0.5, 0.25  # least shares of all and of braked samples within the log [1]
_SLOWS = 1.5 * BITE_Z  # braking whatever the pressure is [g]: above an engine in a low gear
_BITES = (1.0, 2.0)  # pressures up to which f and g act, over `BITE` [1]
_FORCE = 0.05  # standard deviation of f and of g, at these, over the usual deceleration [1]
_EXACT = 1e-10  # square of the rounding error of z [1]
_GROUPS = (4, 8)  # samples of the means that show how residuals are correlated, to 0.4 s


@dataclass(frozen=True)
class PressureDelay:
    """Time by which the deceleration comes after the pressure [s], negative where p is late.

    ``value`` median; ``low`` and ``high`` are its 2 and 98 % quantiles. ``explained`` share of the
    variance of z that the pressure explains [1], ``in_time`` with a delay that brakes may have.
    """

    value: float
    low: float
    high: float
    explained: float
    in_time: float

    @property
    def surely(self) -> float:
        """The value nearest to zero in its interval [s]; 0 if it does not explain enough."""
        trusted = self.explained > LIMITS.explained_late
        return max(self.low, 0.0) + min(self.high, 0.0) if trusted else 0.0

    @property
    def words(self) -> str:
        """The delay of p as text."""
        late = "late" if self.value < 0.0 else "early"
        return f"{abs(self.value):.2f} s {late}"

    @property
    def entry(self) -> str:
        """The line of a channel map that corrects the delay."""
        return f'delay = "{-self.value:.2f} s"'


def delays_of(log: Log, driving: DrivingRecord, limit: float) -> dict[str, PressureDelay]:
    """The delay by pressure channel, until a wheel is at its ``limit`` [s].

    Wheel pressures count where logged: ``p_mc`` does not show a motor, booster or hold.
    """
    pairs = [[f"p_{axle}l", f"p_{axle}r"] for axle in AXLES]
    names = [name for pair in pairs if all(x in log for x in pair) for name in pair]
    pressures = [axle_pressure(log, axle) for axle in AXLES] if names else [log["p_mc"]]
    drives = [log[name] for name in ("T_drive_f", "T_drive_r") if name in log]
    use = driving.moving & (log.time < limit) & (np.abs(log["a_x"]) <= GREATEST_Z * G)
    delay = pressure_delay(log.time, driving.z, pressures, drives, use)
    return dict.fromkeys(names or ["p_mc"], delay) if delay else {}


def pressure_delay(
    time: Array, z: Array, pressures: Sequence[Array], drives: Sequence[Array], use: Mask
) -> PressureDelay | None:
    """The delay of ``z`` [1] after ``pressures`` [Pa]; None with too little braking.

    ``pressures`` of ``p_mc`` or of both axles; ``drives`` torques of engine or motor [N m]; ``use``
    where the car moves, no wheel is at its limit yet and ``z`` is valid; (n,) each.
    """
    step, (time, use, (z, *means)) = step_of(time), _means(time, use, z, *pressures, *drives)
    use = use & (z > -DRIVEN_Z)
    pressed, torques = [p / BITE for p in means[: len(pressures)]], means[len(pressures) :]
    slowed = z > _SLOWS
    active = (np.max(pressed, axis=0) > 1.0) | slowed
    rolling = ~np.logical_or.accumulate(slowed) & is_rolling(z)  # the pressure may be early
    braked, rolled = (step * np.count_nonzero(use & part) for part in (active, rolling))
    if braked < LIMITS.pressure_braked or rolled < LIMITS.pressure_lead_in:
        return None
    places = np.flatnonzero(use & (rolling | (time_since(time, active) < LIMITS.pressure_after)))
    places = places[:: samples_in(LIMITS.pressure_every, step)]
    usual = abs(float(np.median(z[use & active])))
    tried, inside, p = _shifted(time, pressed, places, slowed[places])
    drifting = (time[places] - time[places[0]]) * p
    some = [np.clip(np.max(p, axis=0) / bite, 0.0, 1.0) for bite in _BITES]
    parts = (1.0, *(x[places] for x in torques), *p, *drifting, *some)
    columns = np.empty((tried.size, len(parts), places.size))
    for place, part in enumerate(parts):
        columns[:, place] = part
    beyond = ~inside.all(axis=1)
    columns[beyond] *= inside[beyond, None]
    return _by_chance(tried, columns, z[places], inside, _FORCE * usual)


def _means(time: Array, use: Mask, *signals: Array) -> tuple[Array, Mask, list[Array]]:
    """Times with whole means, whether all samples of each mean are of ``use``, and the means."""
    width = samples_in(LIMITS.pressure_width, step_of(time)) | 1
    inside = slice(width // 2, time.size - width // 2)
    unused, *means = (centred_mean(x, width)[inside] for x in ((~use).astype(float), *signals))
    return time[inside], unused == 0.0, means


def _shifted(
    time: Array, pressures: Sequence[Array], places: Index, counts: Mask
) -> tuple[Array, Mask, Array]:
    """Delays (m,) that leave enough samples at ``places``, and enough braked ones, ``counts`` (n,).

    With each: where the pressures are known (m, n), and the pressures (k, m, n).
    """
    then = time[places] - _TRIED[:, None]
    inside = then <= time[-1]
    enough = np.count_nonzero(inside & counts, axis=1) >= _BRAKED * np.count_nonzero(counts)
    enough &= np.mean(inside, axis=1) > _KEPT
    shifted = np.array([np.interp(then[enough], time, p) for p in pressures])
    return _TRIED[enough], inside[enough], shifted


def _by_chance(
    tried: Array, columns: Array, y: Array, inside: Mask, force: float
) -> PressureDelay | None:
    """Posterior of the delay; None where ``y`` (n,) is constant.

    ``columns`` (m, k, n) of the regression with each of the delays ``tried`` [s] (m,), 0 but
    ``inside`` (m, n), up to the end of the log; ``force`` prior sigma of the last two [1].
    """
    if not np.ptp(y) > _EXACT**0.5:  # a sensor that hangs
        return None
    samples = inside.sum(axis=1)
    gram, side, _ = inner_products(columns, y)
    products, variance = (gram, side, inside @ y**2), float(np.var(y))
    ridge = np.zeros(columns.shape[1])
    for _ in range(2):  # the first one gives the noise, and with it the weight of the prior
        squares = residual_squares(products, ridge) / samples + _EXACT
        cost = samples * np.log(squares / variance)
        best = int(np.argmin(cost))
        A, inner = columns[best, :, : samples[best]].T, y[: samples[best]]
        residual = inner - A @ np.linalg.lstsq(A, inner, rcond=None)[0]
        short = squares[best]
        lasting = max(long_run_variance(residual, size) for size in _GROUPS) + _EXACT
        ridge[-len(_BITES) :] = lasting / force**2
    log_chance = -0.5 * cost * short / lasting - np.log1p(((tried - _USUAL) / _SPREAD) ** 2)
    chance = np.exp(log_chance - np.max(log_chance))
    chance /= np.sum(chance)
    middle = np.cumsum(chance) - 0.5 * chance
    value, low, high = np.interp([0.5, 1.0 - _SURE, _SURE], middle, tried).tolist()
    in_time = float(np.min(squares[np.abs(tried) <= _IN_TIME]))
    shares = 1.0 - float(short) / variance, 1.0 - in_time / variance
    return PressureDelay(value, low, high, *shares)
