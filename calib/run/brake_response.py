"""Response of the brakes to the pressure: its delay, and force that no pressure makes.

    demanded brake force = level (1 + trend t) N(t - delay) + force [braked] - fading [slow] + rest

The demanded force follows from the deceleration. N is the brake force of nominal pads; [braked] is
1 where the pads bite; [slow] rises there from 0 to 1 while a motor hands over to the brakes, before
the car stands. ``force`` is positive for a motor that brakes with the pedal, or a zero of the
pressure that is too low, and negative for a threshold pressure. ``fading``, also positive for a
motor, is the force that is lost if the driver does not press harder during the handover. Fade of
the pads is in the trend, a bias of the accelerometer or an unknown resistance in the rest. The
delay is a shift or a first-order lag, whichever fits better; the response may be wider than either.

Wrong where ABS or a valve limits the brake force: that looks like force without pressure.
"""

from dataclasses import dataclass
from functools import cached_property
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

_STEP = 0.02  # length of the means that are compared [s]
_TRIED = 0.06  # step of the delays that are tried [s]; Gauss-Newton steps refine the best
_LARGEST = 0.5  # largest delay of either sign [s]: `pressure_delay` finds larger ones
_LAGS = np.array([0.04, 0.08, 0.14, 0.22, 0.32, 0.44])  # time constants that are tried [s]
_REFINED = 2  # Gauss-Newton steps of the delay
_USUAL, _SPREAD = 0.02, 0.06
"""Prior mean and sigma of the delay [s]: on a slow ramp the prior alone tells it from a force."""
_WIDTH = 0.25
"""Prior sigma of half the variance of the response time, over the squared delay [1]; a first-order
lag has 1/2, a shift 0. It matters in a fast rise, where a wide response looks like a force."""
_FORCE, _FADING = 0.05, 1.0  # prior sigma of force and fading, over the usual brake force [1]
_GROUP = 10  # means over which residuals are averaged to see how they are correlated: 0.2 s
_LASTING = 1.3
"""Factor on sigma, since noise with a time constant of 0.1 s lasts longer than means over `_GROUP`
show: 1/sqrt(1 - (1 - e^-2)/2), by the variance of the mean of a first-order process."""
_BEFORE = 0.5  # time that is used before the pressure rises [s]: a late pressure rises after z
_AFTER = 0.5  # time that is used after a release [s]: later the engine may drive
_SLOW = 4.0  # speed below which only braking is used [m/s]: an automatic gearbox creeps
_GONE = 1.0  # speed at which a motor has handed over [m/s]; the jerk below it is not used
_LEAST, _AGE = 1.0, 10.0  # time of braking that is needed, unit of time of the trend [s]
_WINDOW, _BETWEEN = 0.3, 0.1  # length of each of two medians that show a step, and between them [s]
_BITTEN = 0.4  # time of braking before a step is looked for [s]: pads and body settle
_STEADY = 0.3  # largest change of the nominal force between the medians [1]: the delay is not exact

_LEVEL, _TREND, _BRAKED, _REST, _FADES, _DELAY, _WIDER = range(7)
"""Columns of the regression: the terms of the formula, the delay, and a wider response."""


class _ForceStep(NamedTuple):
    """Largest step of the braking force that the pressure does not make."""

    time: float = 0.0  # [s]
    share: float = 0.0  # over the usual brake force [1]; positive if the force rises
    sigma: float = 1.0  # scatter of such steps in the run [1]


_NO_STEP = _ForceStep()


@dataclass(frozen=True)
class BrakeResponse:
    """Delay of the brakes, and forces over the usual (median) demanded brake force [1]."""

    level: float  # of the pads over nominal ones [1]
    delay: float  # of the deceleration after the pressure [s]
    delay_sigma: float
    share: float  # ``force`` of the head of the file
    share_sigma: float
    fading: float = 0.0
    fading_sigma: float = _FADING  # the prior, if the car does not brake to a low speed
    force_step: _ForceStep = _NO_STEP


@dataclass(frozen=True)
class BrakeBalance:
    """Forces of a run [N], shapes (n,)."""

    nominal_f: Array  # brake force of nominal pads
    nominal_r: Array
    balance: ForceBalance  # all other forces
    active: Mask  # the pads bite, after the lead-in


def brake_balance(car: Vehicle, effects: Effects, s: Signals) -> BrakeBalance:
    """Compute the forces of a run with the nominal pads of ``car`` and the known effects."""
    nominal_f, nominal_r = brake_forces(car, s.p_f, s.p_r)
    drive = (s.drive_f, s.drive_r)
    end_of_lead_in = np.flatnonzero(s.lead_in)[-1] + 1 if s.lead_in.any() else 0
    after_lead_in = np.arange(s.time.size) >= end_of_lead_in
    return BrakeBalance(
        nominal_f=nominal_f,
        nominal_r=nominal_r,
        balance=force_balance(car, effects, s.time, s.speed, s.z, s.p_f, drive),
        active=after_lead_in & (np.maximum(s.p_f, s.p_r) > BITE),
    )


@dataclass(frozen=True)
class _Means:
    """Means of a run over ``step`` [s], shapes (k,)."""

    step: float
    time: Array  # [s]
    nominal: Array  # N of the head of the file [N]
    demanded: Array  # demanded brake force [N]
    braked: Array  # [braked] of the head of the file [1]
    slow: Array  # [slow] of the head of the file [1]
    inside: Mask  # whether the mean is used

    @classmethod
    def of_run(cls, s: Signals, forces: BrakeBalance) -> "_Means":
        """Compute the means of a run."""
        size = samples_in(_STEP, s.sample_time)
        bites = forces.active.astype(float)
        handed_over = np.clip((FADE_OUT - s.speed) / (FADE_OUT - _GONE), 0.0, 1.0)
        return cls(
            step=size * s.sample_time,
            time=block_mean(s.time, size),
            nominal=block_mean(forces.nominal_f + forces.nominal_r, size),
            demanded=block_mean(forces.balance.demanded, size),
            braked=block_mean(bites, size),
            slow=block_mean(bites * handed_over, size),
            inside=block_mean(_useful(s, forces.active).astype(float), size) == 1.0,
        )

    @cached_property
    def age(self) -> Array:
        """Time from the middle of the run over `_AGE` [1]."""
        return (self.time - float(self.time[self.inside].mean())) / _AGE


def _useful(s: Signals, active: Mask) -> Mask:
    """Mask (n,) of the lead-in, and of braking (``active``) with the time around it."""
    if not active.any():
        return np.zeros_like(active)
    until_braking = time_since(-s.time[::-1], active[::-1])[::-1]  # [s], by the reversed time
    near_braking = (until_braking < _BEFORE) | (time_since(s.time, active) < _AFTER)
    unbraked = (s.lead_in | near_braking) & (s.speed > _SLOW)
    return np.asarray(unbraked | (active & (s.speed > _GONE)))


def brake_response(s: Signals, forces: BrakeBalance) -> BrakeResponse | None:
    """Estimate delay and force without pressure of a run; None if it brakes too little."""
    m = _Means.of_run(s, forces)
    if m.step * float(m.braked[m.inside].sum()) < _LEAST:
        return None
    y = m.demanded[m.inside]
    usual = float(np.median(y[m.braked[m.inside] > 0.5]))
    delay, lagged = _likeliest_delay(m, y)
    for _ in range(_REFINED):
        nominal, braked = (_delayed(m.time, x, delay, lagged=lagged) for x in (m.nominal, m.braked))
        by_delay = -np.gradient(nominal, m.step)
        by_width = -np.gradient(by_delay, m.step)  # by half the variance of the delay
        constant = np.ones_like(nominal)
        terms = nominal, nominal * m.age, braked, constant, -m.slow, by_delay, by_width
        A = np.column_stack(terms)[m.inside]  # in the order of `_LEVEL` to `_WIDER`
        free = np.linalg.lstsq(A, y, rcond=None)[0]
        level = float(free[_LEVEL])
        if not (level > 0.0 and usual > 0.0):
            return None
        variance = long_run_variance(y - A @ free, _GROUP)
        prior_sigma = {
            _BRAKED: _FORCE * usual,
            _FADES: _FADING * usual,
            _DELAY: level * _SPREAD,
            _WIDER: level * (_WIDTH * (delay**2 + _USUAL**2)),
        }
        precision, right_side = A.T @ A / variance, A.T @ y / variance
        for column, sigma in prior_sigma.items():
            precision[column, column] += sigma**-2.0
        # the unknown is level * (change of the delay), whose prior mean is level * (_USUAL - delay)
        right_side[_DELAY] += (_USUAL - delay) / _SPREAD / prior_sigma[_DELAY]
        covariance = np.linalg.inv(precision)
        solution, errors = covariance @ right_side, np.sqrt(np.diag(covariance))
        residual = y - A @ solution
        delay += float(solution[_DELAY]) / level
    return BrakeResponse(
        level=float(solution[_LEVEL]),
        delay=delay,
        delay_sigma=float(errors[_DELAY]) / level,
        share=float(solution[_BRAKED]) / usual,
        share_sigma=float(errors[_BRAKED]) / usual,
        fading=float(solution[_FADES]) / usual,
        fading_sigma=_LASTING * float(errors[_FADES]) / usual,
        force_step=_largest_step(m, nominal[m.inside] * level / usual, residual / usual),
    )


def _likeliest_delay(m: _Means, y: Array) -> tuple[float, bool]:
    """Most probable delay [s] for the demanded force ``y`` [N], and whether it is a lag."""
    tried, nominal, braked = _tried_delays(m)
    nominal, braked = nominal[:, m.inside], braked[:, m.inside]
    constant, slow = np.ones_like(nominal), np.broadcast_to(m.slow[m.inside], nominal.shape)
    columns = np.stack([nominal, nominal * m.age[m.inside], braked, constant, slow], 1)  # (d, 5, k)
    squares = residual_squares(inner_products(columns, y))
    A = columns[int(np.argmin(squares))].T
    variance = long_run_variance(y - A @ np.linalg.lstsq(A, y, rcond=None)[0], _GROUP)
    best = int(np.argmin(squares / variance + ((tried - _USUAL) / _SPREAD) ** 2))
    return float(tried[best]), best >= tried.size - _LAGS.size


def _tried_delays(m: _Means) -> tuple[Array, Array, Array]:
    """Delays [s] (d,), shifts and then lags; the nominal force and [braked] after each, (d, k)."""
    every = samples_in(_TRIED, m.step)
    largest = round(_LARGEST / m.step)
    shifts = np.arange(-largest, largest + 1, every)
    shifts = np.concatenate([[0], shifts[shifts != 0]])  # first, so that argmin prefers no shift
    earlier = np.clip(np.arange(m.time.size) - shifts[:, None], 0, m.time.size - 1)
    lagged = [first_order(m.time, m.nominal, lag)[None] for lag in _LAGS]
    nominal = np.vstack([m.nominal[earlier], *lagged])
    braked = np.vstack([m.braked[earlier], np.broadcast_to(m.braked, (_LAGS.size, m.braked.size))])
    return np.concatenate([shifts * m.step, _LAGS]), nominal, braked


def _delayed(time: Array, x: Array, delay: float, *, lagged: bool) -> Array:
    """Signal ``x`` after a first-order lag if ``lagged``, else after a shift of either sign."""
    if lagged and delay > 0.0:
        return first_order(time, x, delay)
    return np.interp(time - delay, time, x)


def _largest_step(m: _Means, nominal: Array, residual: Array) -> _ForceStep:
    """Largest step of ``residual`` [1] at `m.inside` in the longest braking, where N is steady."""
    time, braked = m.time[m.inside], np.flatnonzero(m.braked[m.inside] == 1.0)
    ends = np.flatnonzero(np.diff(time[braked]) > 1.5 * m.step) + 1
    longest = max(np.split(braked, ends), key=len)
    width, apart = round(_WINDOW / m.step), round((_WINDOW + _BETWEEN) / m.step)
    if longest.size < 2 * apart:
        return _NO_STEP
    signals = np.stack([residual, nominal])[:, longest]
    windows = np.lib.stride_tricks.sliding_window_view(signals, width, axis=1)  # (2, k, width)
    medians, pressed = np.median(windows, axis=-1)  # so that no bump counts
    steps = medians[apart:] - medians[:-apart]
    first_middle = (apart + width) // 2  # between the first two windows
    times = time[longest][first_middle : first_middle + steps.size]
    steady = np.abs(pressed[apart:] - pressed[:-apart]) < _STEADY
    comparable = steady & (times > times[0] + _BITTEN)
    if not comparable.any():
        return _NO_STEP
    largest = int(np.argmax(np.where(comparable, np.abs(steps), 0.0)))
    sigma = scatter(steps[comparable] - np.median(steps[comparable]))
    return _ForceStep(float(times[largest]), float(steps[largest]), sigma)
