"""How late the deceleration comes after the pressure, and how much of it the pressure explains.

    z(t) = a + (b + c t) p + f min(p, 1.5 bar) + g min(p, 3 bar) + d T_drive(t) + rest
                                           with p of t - delay

over the lead-in and all that is braked, by the pressure or by the deceleration. Pads that fade or
dry are in c, lines that lag in the delay, resistance and a bias of a_x in a. Pads that bite late
and a motor that brakes along are in f and g, which are small: on a slow ramp they and a delay are
nearly one. So every delay is weighed by what it leaves, and by how usual it is: brakes have little,
clocks may be apart by anything. Before a log the pressure is as in its first sample, after it
unknown. No vehicle is needed. Wrong where a wheel is at its limit, and where the torque of a motor
goes as the pressure would, at another time.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import AXLES, G
from calib.base.warning import LIMITS, bounds_of
from calib.car.braking import BITE
from calib.logs.clock import step_of
from calib.logs.log import Log
from calib.run.axle_signals import axle_pressure
from calib.run.driving_record import BITE_Z, DRIVEN, GREATEST, DrivingRecord, rolls
from calib.run.filters import (
    centred_mean,
    lasting_variance,
    left_of,
    products_of,
    samples_in,
    since,
)

_TRIED = np.linspace(-4.0, 4.0, 161)  # delays that are tried [s]; two clocks may be anywhere apart
_USUAL, _SPREAD = 0.02, 0.06
"""Delay of brakes and filters as usual, and the half width of its Cauchy distribution [s]: of a
second it says little, where a normal one would deny it."""
_SURE = 0.98  # chance that the delay is above `low`, and that it is below `high` [1]
_KEPT, _BRAKED = 0.5, 0.25  # shares of all samples and of the braked ones that a delay leaves [1]
_SLOWS = 1.5 * BITE_Z  # braking whatever the pressure is [g]: an engine in a low gear is below it
_BITES = (1.0, 2.0)  # pressures up to which f and g act, over `BITE` [1]
_FORCE = 0.05  # standard deviation of f and of g, at these, over the usual deceleration [1]
_EXACT = 1e-10  # square of what the rounding of numbers leaves of z [1]
_GROUPS = (4, 8)  # samples of the means that tell how long residuals last: to 0.4 s


@dataclass(frozen=True)
class PressureDelay:
    """Time by which the deceleration comes after the pressure [s]: below zero where p is late.

    ``value`` is as likely too low as too high; with a chance of 0.98 it is above ``low``, and with
    as much below ``high``. ``explained`` share of the variance of z that the pressure explains with
    the most likely delay, ``in_time`` with one that brakes may have [1].
    """

    value: float
    low: float
    high: float
    explained: float
    in_time: float

    @property
    def surely(self) -> float:
        """The delay nearest to none that it may have [s]; 0 where it does not explain enough."""
        trusted = self.explained > LIMITS.explained_late
        return max(self.low, 0.0) + min(self.high, 0.0) if trusted else 0.0

    @property
    def words(self) -> str:
        """How p lies in time."""
        late = "late" if self.value < 0.0 else "early"
        return f"{abs(self.value):.2f} s {late}"

    @property
    def entry(self) -> str:
        """What puts p in time in a channel map."""
        return f'delay = "{-self.value:.2f} s"'


def delays_of(log: Log, driving: DrivingRecord, limit: float) -> dict[str, PressureDelay]:
    """The delay of the deceleration after each pressure until a wheel is at its ``limit`` [s].

    Of the wheels' where they are logged: behind a motor, a booster or a hold ``p_mc`` says nothing.
    """
    pairs = [[f"p_{axle}l", f"p_{axle}r"] for axle in AXLES]
    names = [name for pair in pairs if all(x in log for x in pair) for name in pair]
    pressures = [axle_pressure(log, axle) for axle in AXLES] if names else [log["p_mc"]]
    drives = [log[name] for name in ("T_drive_f", "T_drive_r") if name in log]
    use = driving.moving & (log.time < limit) & (np.abs(log["a_x"]) <= GREATEST * G)
    delay = pressure_delay(log.time, driving.z, pressures, drives, use)
    return dict.fromkeys(names or ["p_mc"], delay) if delay else {}


def pressure_delay(
    time: Array, z: Array, pressures: Sequence[Array], drives: Sequence[Array], use: Mask
) -> PressureDelay | None:
    """The delay of ``z`` [1] after ``pressures`` [Pa]; None where too little is braked to tell.

    ``time`` [s]; ``pressures`` one, or those of both axles; ``drives`` torques of engine or motor
    [N m]; ``use`` where the car moves, no wheel is at its limit yet and ``z`` is true; (n,) each.
    """
    step, (time, use, (z, *means)) = step_of(time), _means(time, use, z, *pressures, *drives)
    use = use & (z > -DRIVEN)
    pressed, torques = [p / BITE for p in means[: len(pressures)]], means[len(pressures) :]
    slowed = z > _SLOWS
    active = (np.max(pressed, axis=0) > 1.0) | slowed
    rolling = ~np.logical_or.accumulate(slowed) & rolls(z)  # a pressure that is early is no brake
    braked, rolled = (step * np.count_nonzero(use & part) for part in (active, rolling))
    if braked < LIMITS.pressure_braked or rolled < LIMITS.pressure_lead_in:
        return None
    places = np.flatnonzero(use & (rolling | (since(time, active) < LIMITS.pressure_after)))
    places = places[:: samples_in(LIMITS.pressure_every, step)]
    usual = abs(float(np.median(z[use & active])))
    tried, inside, p = _shifted(time, pressed, places, slowed[places])
    drifting = (time[places] - time[places[0]]) * p
    some = [np.clip(np.max(p, axis=0) / bite, 0.0, 1.0) for bite in _BITES]
    others = (np.ones(places.size), *(x[places] for x in torques))
    alike = [np.broadcast_to(x, inside.shape) for x in others]
    columns = np.stack([*alike, *p, *drifting, *some], axis=1)
    return _by_chance(tried, columns, z[places], inside, _FORCE * usual)


def _means(time: Array, use: Mask, *signals: Array) -> tuple[Array, Mask, list[Array]]:
    """The times that have whole means, where all of these is of ``use``, and those of signals."""
    width = samples_in(LIMITS.pressure_width, step_of(time)) | 1
    inside = slice(width // 2, time.size - width // 2)
    unused, *means = (centred_mean(x, width)[inside] for x in ((~use).astype(float), *signals))
    return time[inside], unused == 0.0, means


def _shifted(
    time: Array, pressures: Sequence[Array], places: Index, counts: Mask
) -> tuple[Array, Mask, Array]:
    """Delays (m,) that leave enough of what ``counts`` (n,) of the samples ``places``.

    With each whether the pressures are known there (m, n), and what they are (k, m, n).
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
    """The delay by its likelihood and by what is usual; None where ``y`` has no course.

    ``y`` (n,) is made of the ``columns`` (m, k, n) with each of the delays ``tried`` [s] (m,),
    where it is ``inside`` (m, n); ``force`` is the spread of the last two [1].
    """
    if not np.ptp(y) > _EXACT**0.5:  # a sensor that hangs
        return None
    columns, y, samples = columns * inside[:, None], y * inside, inside.sum(axis=1)
    products = products_of(columns, y)
    ridge, variance = np.zeros(columns.shape[1]), float(np.var(y[np.abs(tried).argmin()]))
    for _ in range(2):  # the noise is known after the first, and with it the weight of f and g
        squares = left_of(products, ridge) / samples + _EXACT
        cost = samples * np.log(squares / variance)
        best = int(np.argmin(cost))
        A = columns[best].T
        residual = (y[best] - A @ np.linalg.lstsq(A, y[best], rcond=None)[0])[: samples[best]]
        short = squares[best]
        lasting = max(lasting_variance(residual, size) for size in _GROUPS) + _EXACT
        ridge[-len(_BITES) :] = lasting / force**2
    log_chance = -0.5 * cost * short / lasting - np.log1p(((tried - _USUAL) / _SPREAD) ** 2)
    chance = np.exp(log_chance - np.max(log_chance))
    chance /= np.sum(chance)
    middle = np.cumsum(chance) - 0.5 * chance
    value, low, high = np.interp([0.5, 1.0 - _SURE, _SURE], middle, tried).tolist()
    in_time = float(np.min(squares[np.abs(tried) <= bounds_of("pressure_clock")[1]]))
    shares = 1.0 - float(short) / variance, 1.0 - in_time / variance
    return PressureDelay(value, low, high, *shares)
