"""Response of the brakes to the pressure: its delay, and force that no pressure makes.

    demanded brake force = level (1 + trend t) N(t - delay) + force [braked] - fading [slow] + rest

N is the brake force of nominal pads. ``force`` is positive for a motor that brakes with the pedal,
or a zero of the pressure that is too low, and negative for a threshold pressure. A motor hands over
to the brakes before the car stands. If the driver does not press harder, that force is lost:
``fading`` is positive, also for a motor that follows the pedal. Fade of the pads is in the trend, a
bias of the accelerometer or an unknown resistance in the rest. The delay is a shift or a
first-order lag, whichever fits better, with an unknown width. Not causal: it uses the whole run.
Wrong where ABS or a valve limits the brake force: that looks like force without pressure.
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
from calib.run.filters import (
    block_mean,
    inner_products,
    long_run_variance,
    residual_squares,
    samples_in,
    time_since,
)

_STEP = 0.02  # of the means that are compared [s]
_TRIED = 0.06  # step of the delays that are tried [s]; Gauss-Newton steps refine the best
_EARLIEST, _LATEST = -0.5, 0.5  # delays that are tried [s]: `pressure_delay` finds greater ones
_LAGS = np.array([0.04, 0.08, 0.14, 0.22, 0.32, 0.44])  # time constants that are tried [s]
_REFINED = 2  # Gauss-Newton steps of the delay
_USUAL, _SPREAD = 0.02, 0.06
"""Prior of the delay of brakes and filters, mean and standard deviation [s]: on a slow ramp a delay
and a force are nearly collinear, and only the prior separates them."""
_WIDTH = 0.25
"""Prior sigma of half the variance of the response time, over the squared delay [1]: a first-order
lag has 1/2, a shift 0. In a fast rise a wide response looks like a force."""
_FORCE = 0.05
"""Standard deviation of the force over the usual brake force before the run [1]."""
_GROUP = 10  # means over which residuals are averaged to see how they are correlated: 0.2 s
_LASTING = 1.3
"""Factor on sigma for noise with a time constant of 0.1 s, over half a second, beyond what means
over `_GROUP` show: 1/sqrt(1 - (1 - e^-2)/2), variance of the mean of a first-order process."""
_AFTER = 0.5  # time after a release that is used [s]; later the engine may drive
_BEFORE = 0.5  # time before the pressure rises that is used [s]: a late pressure rises after z
_SLOW = 4.0  # speed below which only braking is used [m/s]: an automatic gearbox creeps
_GONE = 1.0  # speed at which a motor has handed over [m/s]; the jerk below it is not used
_FADING = 1.0  # prior sigma of the fading force, over the same as `_FORCE` [1]: hardly informative
_LEAST = 1.0  # time of braking that is needed [s]
_AGE = 10.0  # time over which the trend is written [s]
_WINDOW, _BETWEEN = 0.3, 0.1  # time of two medians, whose difference is a step [s]
_BITTEN = 0.4  # time of braking before a step is looked for [s]: pads and body settle
_STEADY = 0.3  # largest change of the nominal force between the medians [1]: the delay is not exact


class _ForceStep(NamedTuple):
    """The largest step of the braking force that the pressure does not make, at ``time`` [s].

    ``share`` of the usual brake force [1], positive where the car brakes more after it;
    ``sigma`` scatter of such steps in the run [1].
    """

    time: float = 0.0
    share: float = 0.0
    sigma: float = 1.0


_NO_STEP = _ForceStep()


@dataclass(frozen=True)
class BrakeResponse:
    """Delay of the brakes [s] and force without pressure, each with its standard deviation.

    ``level`` of the pads over nominal [1]; ``delay`` positive where the deceleration comes after
    the pressure; ``share`` the force, and ``fading`` the one lost at low speed, over the median
    demanded brake force [1]; the sigma of ``fading`` is `_FADING` where the run does not show it.
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
    squares = residual_squares(inner_products(columns, y))
    A = columns[int(np.argmin(squares))].T
    variance = long_run_variance(y - A @ np.linalg.lstsq(A, y, rcond=None)[0], _GROUP)
    # maximum a posteriori over the delays that were tried
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
        variance = long_run_variance(y - A @ free, _GROUP)
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
    """The largest step of ``residual`` in the longest braking, by medians, so that no bump counts.

    ``nominal`` and ``residual`` (n,) over the usual brake force [1]; ``step`` [s].
    """
    on = np.flatnonzero(braked == 1.0)
    longest = max(np.split(on, np.flatnonzero(np.diff(time[on]) > 1.5 * step) + 1), key=len)
    width, apart = round(_WINDOW / step), round((_WINDOW + _BETWEEN) / step)
    if longest.size < 2 * apart:
        return _NO_STEP
    windows = np.lib.stride_tricks.sliding_window_view(
        np.stack([residual, nominal])[:, longest], width, axis=1
    )
    middle = [(width - 1) // 2, width // 2]
    levels, pressed = np.partition(windows, middle, axis=-1)[..., middle].mean(axis=-1)
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
    """``x`` after a first-order lag, or a shift, which may be negative."""
    if lagged and delay > 0.0:
        return first_order(time, x, delay)
    return np.interp(time - delay, time, x)


def _useful(s: Signals, active: Mask) -> Mask:
    """Samples (n,) of the lead-in, and of braking with what is just before and after it."""
    if not active.any():
        return np.zeros_like(active)
    soon = time_since(-s.time[::-1], active[::-1])[::-1] < _BEFORE
    fast = (s.lead_in | soon | (time_since(s.time, active) < _AFTER)) & (s.speed > _SLOW)
    return np.asarray(fast | (active & (s.speed > _GONE)))


def _tried(time: Array, nominal: Array, braked: Array, step: float) -> tuple[Array, Array, Array]:
    """Delays [s] (m,): none, shifts, first-order lags; both signals after each of them (m, n)."""
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
