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
from functools import partial

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import AXLES, G
from calib.base.warning import LIMITS, bounds_of
from calib.car.braking import BITE
from calib.logs.clock import step_of
from calib.logs.log import Log
from calib.run.axle_signals import axle_pressure
from calib.run.driving_record import BITE_Z, DRIVEN, GREATEST, DrivingRecord, rolls
from calib.run.filters import centred_mean, lasting_variance, left_of, products_of, since

_TRIED = np.linspace(-4.0, 4.0, 161)  # delays that are tried [s]; two clocks may be anywhere apart
_USUAL, _SPREAD = 0.02, 0.06
"""Delay of brakes and filters as usual, and the half width of its Cauchy distribution [s]: of a
second it says little, where a normal one would deny it."""
_SURE = 0.98  # chance that the delay is above `low`, and that it is below `high` [1]
_KEPT, _BRAKED = 0.5, 0.25  # shares of all samples and of the braked ones that a delay leaves [1]
_SLOWS = 1.5 * BITE_Z  # braking whatever the pressure is [g]: an engine in a low gear is below it
_BITES = (1.0, 2.0)  # pressures up to which f and g act, over `BITE` [1]
_FORCE = 0.05  # standard deviation of f and of g, at these, over the usual deceleration [1]
_KNEES = (0.125, 0.25, 0.375, 0.5, 0.75)
"""Shares of the highest pressure at which that of a wheel may bend [1]."""
_HYSTERESIS = 0.003  # of a wheel's pressure over that of the master cylinder, of the highest [1]
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

    def less(self, other: "PressureDelay") -> "PressureDelay":
        """The delay after a pressure that comes ``other`` later than this one's."""
        return PressureDelay(
            self.value - other.value,
            self.low - other.high,
            self.high - other.low,
            min(self.explained, other.explained),
            self.in_time,
        )


def delays_of(log: Log, driving: DrivingRecord, limit: float) -> dict[str, PressureDelay]:
    """The delay of the deceleration after each pressure until a wheel is at its ``limit`` [s].

    Wheels are told by the master cylinder where they follow it, and the deceleration agrees; else
    by the deceleration, and nothing is said of ``p_mc``: a motor, a booster or a hold is between.
    """
    use = driving.moving & (log.time < limit)
    pairs = [[f"p_{axle}l", f"p_{axle}r"] for axle in AXLES]
    names = [name for pair in pairs if all(x in log for x in pair) for name in pair]
    drives = [log[name] for name in ("T_drive_f", "T_drive_r") if name in log]
    true = use & (np.abs(log["a_x"]) <= GREATEST * G)
    of_z = partial(pressure_delay, log.time, driving.z, drives=drives, use=true)
    master = of_z([log["p_mc"]])
    wheels = of_z([axle_pressure(log, axle) for axle in AXLES]) if names else None
    if master is None or wheels is None:
        return {"p_mc": master} if master else {}
    if not drives:
        behind = [_delay_of_wheel(log.time, log[name], log["p_mc"], use) for name in names]
        delays = [master.less(x) for x in behind if x and x.explained > LIMITS.explained_curve]
        if len(delays) == len(names):
            low, high = min(x.low for x in delays), max(x.high for x in delays)
            if wheels.low <= high and low <= wheels.high:
                return {"p_mc": master, **dict(zip(names, delays, strict=True))}
    return dict.fromkeys(names, wheels)


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
    places = places[:: max(1, round(LIMITS.pressure_every / step))]
    usual = abs(float(np.median(z[use & active])))
    tried, inside, p = _shifted(time, pressed, places, slowed[places])
    drifting = (time[places] - time[places[0]]) * p
    some = [np.clip(np.max(p, axis=0) / bite, 0.0, 1.0) for bite in _BITES]
    others = [
        np.broadcast_to(x, inside.shape)
        for x in (np.ones(places.size), *(x[places] for x in torques))
    ]
    columns = np.stack([*others, *p, *drifting, *some], axis=1)
    return _by_chance(tried, columns, z[places], inside, _EXACT, _FORCE * usual)


def _delay_of_wheel(time: Array, wheel: Array, master: Array, use: Mask) -> PressureDelay | None:
    """The delay of a wheel's pressure after the ``master`` cylinder's [Pa]; None without braking.

    A valve between them may limit or reduce: the one is a curve over the other. ``time`` [s];
    ``use`` where the car moves and no wheel is at its limit yet; (n,) each.
    """
    step, (time, use, (wheel, master)) = step_of(time), _means(time, use, wheel, master)
    wheel, master = wheel / BITE, master / BITE
    pressed, highest = wheel > 1.0, float(np.max(master))
    if step * np.count_nonzero(use & pressed) < LIMITS.pressure_braked or highest < 1.0:
        return None
    places = np.flatnonzero(use)[:: max(1, round(LIMITS.pressure_every / step))]
    tried, inside, p = _shifted(time, [master], places, pressed[places])
    parts = (np.minimum(p[0], share * highest) for share in _KNEES)
    columns = np.stack([np.ones_like(p[0]), *p, *parts], axis=1)
    return _by_chance(tried, columns, wheel[places] / highest, inside, _HYSTERESIS**2)


def _means(time: Array, use: Mask, *signals: Array) -> tuple[Array, Mask, list[Array]]:
    """The times that have whole means, where all of these is of ``use``, and those of signals."""
    width = max(1, round(LIMITS.pressure_width / step_of(time))) | 1
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
    return (
        _TRIED[enough],
        inside[enough],
        np.array([np.interp(then[enough], time, p) for p in pressures]),
    )


def _by_chance(
    tried: Array,
    columns: Array,
    y: Array,
    inside: Mask,
    least: float,
    force: float = np.inf,
) -> PressureDelay | None:
    """The delay by its likelihood and by what is usual; None where ``y`` has no course.

    ``y`` (n,) is made of the ``columns`` (m, k, n) with each of the delays ``tried`` [s] (m,),
    where it is ``inside`` (m, n), but for ``least`` [1], the variance of what no column has;
    ``force`` the spread of the last two [1].
    """
    if not np.ptp(y) > _EXACT**0.5:  # a sensor that hangs
        return None
    columns, y, samples = columns * inside[:, None], y * inside, inside.sum(axis=1)
    products = products_of(columns, y)
    ridge, variance = np.zeros(columns.shape[1]), float(np.var(y[np.abs(tried).argmin()]))
    for _ in range(2):  # the noise is known after the first, and with it the weight of f and g
        squares = left_of(products, ridge) / samples + least
        cost = samples * np.log(squares / variance)
        best = int(np.argmin(cost))
        A = columns[best].T
        residual = (y[best] - A @ np.linalg.lstsq(A, y[best], rcond=None)[0])[: samples[best]]
        short = squares[best]
        lasting = max(lasting_variance(residual, size) for size in _GROUPS) + least
        ridge[-len(_BITES) :] = lasting / force**2
    log_chance = -0.5 * cost * short / lasting - np.log1p(((tried - _USUAL) / _SPREAD) ** 2)
    chance = np.exp(log_chance - np.max(log_chance))
    chance /= np.sum(chance)
    middle = np.cumsum(chance) - 0.5 * chance
    value, low, high = np.interp([0.5, 1.0 - _SURE, _SURE], middle, tried).tolist()
    in_time = float(np.min(squares[np.abs(tried) <= bounds_of("pressure_clock")[1]]))
    shares = 1.0 - float(short) / variance, 1.0 - in_time / variance
    return PressureDelay(value, low, high, *shares)
