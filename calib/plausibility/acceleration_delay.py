r"""Delay of the accelerometer against a speed: v where it is logged, else the rims of the wheels.

    u(t) = v_0 - e t - (1 + c) I(t + tau) + errors       I = g int z dt, with z as read

    u   -----\               a_x is late by tau: at the bite, I bends later than u. An offset e and
    I   -------\             a scale c bend nothing there, so tau can be separated from them.

The rims are slower than the car by their slip, whose coefficients have the prior of any tyre. The
errors are white noise of u, the random walk that the noise of z makes in I, and the slope of the
road, which is even or changes. The first braking is compared, with the rolling before it. A delay
longer than `_LONGEST` is not seen. Without v a motor that follows no pedal looks like a delay.
"""

from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import white_noise
from calib.base.names import G
from calib.car.braking import MOVING
from calib.plausibility.speed_mistakes import SLIP
from calib.run.driving_record import GREATEST_Z
from calib.run.filters import block_mean, samples_in
from calib.run.run import Run
from calib.run.speed_delay import CHANGING, EVEN, ODDS_ROAD

_LONGEST = 0.6
_TRIED = np.linspace(-_LONGEST, _LONGEST, 61)  # delays [s], equally likely
_STEP, _FEWEST = 0.1, 15  # time over which signals are averaged [s]; number of means needed
_ROLLED, _BRAKED = 3.0, 12.0  # longest times before and after the bite that are compared [s]
_START, _SLOPE, _SCALE, _RADIUS = 100.0, 0.5, 0.02, 0.01
"""Prior sigma of v_0 [m/s], of e [m/s^2], of c [1] and of a rolling radius [1]."""
_COLOUR = 2.0  # noise of z over a second over its white part [1]: logs have 1.5 to 4, by the road
_FINEST = 1e-3  # least noise of u, and of z times a step [m/s]
_FORM = 0.045
"""Sigma that lag of the brakes, form of tyres and pitch add without v [s], by 234 sound logs."""


class AccelerationDelay(NamedTuple):
    """Time by which a_x comes after a speed [s]."""

    value: float
    sigma: float
    against: str  # name of the speed


def acceleration_delay(run: Run) -> AccelerationDelay | None:
    """Estimate the delay of a_x of a run with a vehicle; None if its first braking is too short."""
    compared, has_v = _compared_blocks(run), run.blocks.v is not None
    size = samples_in(_STEP, run.blocks.length)
    if compared.stop - compared.start < _FEWEST * size:
        return None
    time, speed, z, pressure, *lost = block_mean(_signals(run, compared), size)  # each (n,)
    if not np.any(pressure > 0.0):  # the car slows, but not by its brakes
        return None
    undelayed = lost[_TRIED.size // 2]  # I at a delay of 0 s
    columns = [np.ones_like(time), time - time[0], undelayed]  # factors of v_0, e and c
    sigma = [_START, _SLOPE, _SCALE]
    noise = white_noise(speed, 2), _COLOUR * G * size * run.blocks.length * white_noise(z, 2)
    if not has_v:
        slips = SLIP[:3]  # mean and sigma of the coefficients of z, z^2 and z^3
        smooth_z = pressure * float(z @ pressure) / float(pressure @ pressure)
        columns += [speed, *(speed * smooth_z**power for power in (1, 2, 3))]
        sigma += [_RADIUS, *(spread for _, spread in slips)]
        speed = speed * (1.0 + slips[0][0] * smooth_z)
    regained = speed + np.array(lost)  # (m, n), explained by the columns at the true delay
    value, spread = _posterior(time, regained, np.array(columns).T, np.array(sigma), noise)
    if has_v:
        return AccelerationDelay(value, spread, "v")
    return AccelerationDelay(value, float(np.hypot(spread, _FORM)), "the wheel speeds")


def _compared_blocks(run: Run) -> slice:
    """Blocks of the rolling before the first braking, and of that braking; may be empty."""
    b = run.blocks
    rolled = np.flatnonzero(b.lead_in)
    if not rolled.size or rolled[-1] + 1 == b.end.size:
        return slice(0, 0)
    bite = rolled[-1] + 1
    first = max(rolled[0], bite - round(_ROLLED / b.length))
    last = min(bite + round(_BRAKED / b.length), b.end.size)
    latest = min(run.first_slip, b.end[-1] - _LONGEST)
    unusable = (b.speed < MOVING) | (np.abs(b.z) > GREATEST_Z) | (b.end > latest)
    stops = np.flatnonzero(unusable[first:last])
    return slice(int(first), int(first + stops[0] if stops.size else last))


def _signals(run: Run, compared: slice) -> Array:
    """Time, speed, z, pressure, and I at each tried delay, in the compared blocks (4 + m, n)."""
    b = run.blocks
    speed = b.rim_speed(run.car) if b.v is None else b.v
    lost = b.speed_lost(b.z)  # I
    shifted = (np.interp(b.end[compared] + delay, b.end, lost) for delay in _TRIED)
    return np.array([*(x[compared] for x in (b.end, speed, b.z, b.p_f + b.p_r)), *shifted])


def _posterior(
    time: Array, regained: Array, columns: Array, sigma: Array, noise: tuple[float, float]
) -> tuple[float, float]:
    """Mean and sigma of tau [s] from ``regained`` [m/s] (m, n), which is u + I at each delay.

    The coefficients of ``columns`` (n, k) have the prior ``sigma`` (k,). ``noise`` [m/s] is that of
    u, and of I over one `_STEP`.
    """
    white, walk = (max(x, _FINEST) ** 2 for x in noise)
    age = time - time[0]
    earlier, later = np.minimum.outer(age, age), np.maximum.outer(age, age)
    errors = white * np.eye(age.size) + walk / _STEP * earlier + columns * sigma**2 @ columns.T
    by_slope = earlier**2 * (3.0 * later - earlier) / 6.0  # a random walk, integrated once
    # below: a row for each kind of road, a column for each delay (2, m)
    roots = [np.linalg.cholesky(errors + (G * q) ** 2 * by_slope) for q in (EVEN, CHANGING)]
    misfit = np.array([np.sum(np.linalg.solve(root, regained.T) ** 2, axis=0) for root in roots])
    log_norm = np.array([[np.log(np.diag(root)).sum()] for root in roots])
    excess = max(float(misfit.min()) / age.size, 1.0)  # true variance over the assumed one
    log_posterior = -0.5 * misfit / excess - log_norm + np.log(ODDS_ROAD)[:, None]
    probability = np.exp(log_posterior - log_posterior.max()).sum(axis=0)  # (m,)
    probability /= probability.sum()
    mean = float(probability @ _TRIED)
    return mean, float(np.sqrt(probability @ (_TRIED - mean) ** 2))
