"""How the brakes of a run answer the pressure: how late, and with what force besides.

    demanded brake force = level (1 + trend t) N(t - delay) + force [braked] - fading [slow] + rest

N is the brake force of nominal pads. A motor that brakes with the pedal, or a zero of the pressure
that is too low, is force without pressure: `force` above zero. A pressure below which nothing
happens is `force` below zero. A motor hands over to the brakes before the car stands; where nobody
raises the pressure for it, a force goes with the speed: `fading` above zero. It shows a motor that
follows the pedal, too, which is no force without pressure. Pads that fade are in the trend, a bias
of the accelerometer or an unknown resistance in the rest. The delay is a shift of the pressure or a
first-order lag, whichever fits better; how far the answer is drawn out besides is open. Uses the
whole run, so it is no part of a causal estimate. Wrong where the brake force is limited, by ABS or
on the rear axle: it looks like force without pressure.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import scatter
from calib.car.balance import ForceBalance, brake_forces, force_balance
from calib.car.braking import BITE
from calib.car.effects.effects import Effects
from calib.car.effects.wheels import FADE_OUT
from calib.car.lag import first_order
from calib.car.vehicle import Vehicle
from calib.run.axle_signals import Signals
from calib.run.filters import block_mean, lasting_variance, left_of, products_of, samples_in, since

_STEP = 0.02  # of the means that are compared [s]
_TRIED = 0.06  # of the delays that are tried [s]; the slope by the delay tells the rest
_EARLIEST, _LATEST = -0.5, 0.5  # delays that are tried [s]: `pressure_delay` tells greater ones
_LAGS = np.array([0.04, 0.08, 0.14, 0.22, 0.32, 0.44])  # time constants that are tried [s]
_REFINED = 2  # times that the slope by the delay is followed
_USUAL, _SPREAD = 0.02, 0.06
"""Delay of brakes and filters as usual, and its standard deviation [s]: on a slow ramp a delay and
a force are nearly one, and only what is usual tells them apart."""
_WIDTH = 0.25
"""Standard deviation of half the variance of the time by which the brakes come late, over the
square of the delay [1]: a first-order lag has 1/2 more than a shift. In a fast rise an answer that
is drawn out looks like a force."""
_FORCE = 0.05
"""Standard deviation of the force over the usual brake force before the run [1]."""
_GROUP = 10  # means over which residuals are averaged to see how they are correlated: 0.2 s
_LASTING = 1.3
"""How much more noise that lasts 0.1 s errs over half a second than its means over `_GROUP` say:
1/sqrt(1 - (1 - e^-2)/2), by the variance of the mean of a first-order process."""
_AFTER = 0.5  # time after a release that still tells of the brakes [s]; later the engine may drive
_BEFORE = 0.5  # time before the pressure rises, in which a car brakes whose pressure is late [s]
_SLOW = 4.0  # speed below which only what is braked is used [m/s]: a gearbox makes the car creep
_GONE = 1.0  # speed at which a motor has handed over, and nothing is used below it [m/s]: a jerk
_FADING = 1.0  # sigma of the force that goes with the speed, as `_FORCE`: nearly nothing is known
_LEAST = 1.0  # time of braking that is needed [s]
_AGE = 10.0  # time over which the trend is written [s]
_WINDOW, _BETWEEN = 0.3, 0.1  # time of two medians, whose difference is a step [s]
_BITTEN = 0.4  # time of braking before a step is looked for [s]: pads and body are not at rest
_STEADY = 0.3
"""Change of the nominal brake force between the medians, over the usual one [1], beyond which a
step says nothing: it may be the delay, that is not exact."""


class _ForceStep(NamedTuple):
    """The largest step of the braking force that the pressure does not make.

    ``time`` [s]; ``share`` over the usual brake force [1], above zero where the car brakes more
    after it; ``sigma`` scatter of such steps in the run [1]. None in a run that is too short.
    """

    time: float = 0.0
    share: float = 0.0
    sigma: float = 1.0


_NO_STEP = _ForceStep()


@dataclass(frozen=True)
class BrakeResponse:
    """Delay of the brakes [s] and force without pressure, each with its standard deviation.

    ``level`` the pads over the nominal ones [1]; ``delay`` is above zero where the deceleration
    comes after the pressure. ``share`` is the force over the median demanded brake force [1],
    ``fading`` the one that goes as the car gets slow over the same [1]: its sigma is `_FADING`
    where the run does not show it. ``step`` is the largest step of the force beside the pressure.
    """

    level: float
    delay: float
    delay_sigma: float
    share: float
    share_sigma: float
    fading: float = 0.0
    fading_sigma: float = _FADING
    step: _ForceStep = _NO_STEP


@dataclass(frozen=True)
class BrakeBalance:
    """Forces of a run [N], shapes (n,).

    ``nominal_f``, ``nominal_r`` brake forces of nominal pads; ``balance`` all others; ``active``
    where the pads bite, after the lead-in.
    """

    nominal_f: Array
    nominal_r: Array
    balance: ForceBalance
    active: Mask


def brake_response(s: Signals, forces: BrakeBalance) -> BrakeResponse | None:
    """Delay and force without pressure of a run; None if it brakes too little to tell."""
    size = samples_in(_STEP, s.sample_time)
    step = size * s.sample_time
    active = forces.active.astype(float)
    time, nominal, demanded, braked, slow, use = (
        block_mean(x, size)
        for x in (
            s.time,
            forces.nominal_f + forces.nominal_r,
            forces.balance.demanded,
            active,
            active * np.clip((FADE_OUT - s.speed) / (FADE_OUT - _GONE), 0.0, 1.0),
            _useful(s, forces.active).astype(float),
        )
    )
    inside = use == 1.0
    if step * float(braked[inside].sum()) < _LEAST:
        return None
    age = (time - float(time[inside].mean())) / _AGE
    y = demanded[inside]
    usual = float(np.median(y[braked[inside] > 0.5]))
    constant = np.ones_like(time)
    tried, late, on = _tried(time, nominal, braked, step)
    late, on = late[:, inside], on[:, inside]
    others = (np.broadcast_to(x[inside], late.shape) for x in (constant, slow))
    columns = np.stack([late, late * age[inside], on, *others], 1)
    squares = left_of(products_of(columns, y[None]))
    A = columns[int(np.argmin(squares))].T
    variance = lasting_variance(y - A @ np.linalg.lstsq(A, y, rcond=None)[0], _GROUP)
    # the most probable delay: the least residual, weighed with what is usual
    best = int(np.argmin(squares / variance + ((tried - _USUAL) / _SPREAD) ** 2))
    lagged, delay = best >= tried.size - _LAGS.size, float(tried[best])
    for _ in range(_REFINED):
        n, applied = (_delayed(time, x, delay, lagged=lagged) for x in (nominal, braked))
        slope = -np.gradient(n, step)  # by the delay
        width = -np.gradient(slope, step)  # by half its variance
        A = np.column_stack([n, n * age, applied, constant, -slow, slope, width])[inside]
        free = np.linalg.lstsq(A, y, rcond=None)[0]
        level = float(free[0])
        if not (level > 0.0 and usual > 0.0):
            return None
        variance = lasting_variance(y - A @ free, _GROUP)
        smeared = _WIDTH * (delay**2 + _USUAL**2)
        spread = {2: _FORCE * usual, 4: _FADING * usual, 5: level * _SPREAD, 6: level * smeared}
        precision, side = A.T @ A / variance, A.T @ y / variance
        for column, sigma in spread.items():
            precision[column, column] += sigma**-2.0
        side[5] += (_USUAL - delay) / _SPREAD / spread[5]
        covariance = np.linalg.inv(precision)
        solution, errors = covariance @ side, np.sqrt(np.diag(covariance))
        residual = y - A @ solution
        delay += float(solution[5]) / level
    return BrakeResponse(
        level=float(solution[0]),
        delay=delay,
        delay_sigma=float(errors[5]) / level,
        share=float(solution[2]) / usual,
        share_sigma=float(errors[2]) / usual,
        fading=float(solution[4]) / usual,
        fading_sigma=_LASTING * float(errors[4]) / usual,
        step=_step(step, time[inside], braked[inside], n[inside] * level / usual, residual / usual),
    )


def _step(step: float, time: Array, braked: Array, nominal: Array, residual: Array) -> _ForceStep:
    """The largest step of ``residual`` (n,) in the longest braking, by medians: a bump is no step.

    ``nominal`` what the pressure makes; both over the usual brake force [1]; ``step`` [s].
    """
    on = np.flatnonzero(braked == 1.0)
    longest = max(np.split(on, np.flatnonzero(np.diff(time[on]) > 1.5 * step) + 1), key=len)
    width, apart = round(_WINDOW / step), round((_WINDOW + _BETWEEN) / step)
    if longest.size < 2 * apart:
        return _NO_STEP
    levels, pressed = (
        np.median(np.lib.stride_tricks.sliding_window_view(x[longest], width), axis=-1)
        for x in (residual, nominal)
    )
    steps = levels[apart:] - levels[:-apart]
    middles = time[longest][(apart + width) // 2 :][: steps.size]
    comparable = (np.abs(pressed[apart:] - pressed[:-apart]) < _STEADY) & (
        middles > middles[0] + _BITTEN
    )
    if not comparable.any():
        return _NO_STEP
    largest = int(np.argmax(np.where(comparable, np.abs(steps), 0.0)))
    sigma = scatter(steps[comparable] - np.median(steps[comparable]))
    return _ForceStep(float(middles[largest]), float(steps[largest]), sigma)


def _delayed(time: Array, x: Array, delay: float, *, lagged: bool) -> Array:
    """``x`` after a shift of the clock or a lag; a lag of nothing or less is a shift."""
    if lagged and delay > 0.0:
        return first_order(time, x, delay)
    return np.interp(time - delay, time, x)


def _useful(s: Signals, active: Mask) -> Mask:
    """The lead-in, and all that is braked, has just been or is about to be, (n,)."""
    if not active.any():
        return np.zeros_like(active)
    soon = since(-s.time[::-1], active[::-1])[::-1] < _BEFORE
    fast = (s.lead_in | soon | (since(s.time, active) < _AFTER)) & (s.speed > _SLOW)
    return np.asarray(fast | (active & (s.speed > _GONE)))


def _tried(time: Array, nominal: Array, braked: Array, step: float) -> tuple[Array, Array, Array]:
    """Delays [s] (m,) and with each of them ``nominal`` and ``braked``, (m, n) each.

    First no delay, then shifts of the clock, then first-order lags.
    """
    each = samples_in(_TRIED, step)
    shifts = np.arange(round(_EARLIEST / step), round(_LATEST / step) + 1, each)
    shifts = np.concatenate([[0], shifts[shifts != 0]])
    places = np.clip(np.arange(time.size) - shifts[:, None], 0, time.size - 1)
    late = np.vstack([nominal[places], *(first_order(time, nominal, lag)[None] for lag in _LAGS)])
    on = np.vstack([braked[places], np.broadcast_to(braked, (_LAGS.size, braked.size))])
    return np.concatenate([shifts * step, _LAGS]), late, on


def brake_balance(car: Vehicle, effects: Effects, s: Signals) -> BrakeBalance:
    """Balance of a run with the nominal pads of ``car`` and the known effects."""
    nominal_f, nominal_r = brake_forces(car, s.p_f, s.p_r)
    drive = (s.drive_f, s.drive_r)
    began = ~np.logical_or.accumulate(s.lead_in[::-1])[::-1]  # all along without a lead-in
    return BrakeBalance(
        nominal_f=nominal_f,
        nominal_r=nominal_r,
        balance=force_balance(car, effects, s.time, s.speed, s.z, s.p_f, drive),
        active=began & (np.maximum(s.p_f, s.p_r) > BITE),
    )
