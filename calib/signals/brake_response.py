"""How the brakes of a run answer the pressure: how late, and with what force besides.

    demanded brake force = level (1 + trend t) N(t - delay) + force [braked] + rest

N is the brake force of nominal pads. A motor that brakes with the pedal, or a zero of the pressure
that is too low, is force without pressure: `force` above zero. A pressure below which nothing
happens is `force` below zero. Pads that fade are in the trend, a bias of the accelerometer or an
unknown resistance in the rest. The delay is a shift of the pressure or a first-order lag, whichever
fits better. Uses the whole run, so it is no part of a causal estimate. Wrong where the brake force
is limited, by ABS or on the rear axle: it looks like force without pressure.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.physics.lag import first_order
from calib.signals.axle_signals import Signals
from calib.signals.brake_balance import BrakeBalance
from calib.signals.filters import block_mean

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Columns = Callable[[str, float], Array]

STEP = 0.02
"""Step of the means that are compared [s]."""
TRIED = 0.04
"""Step of the delays that are tried [s]; the slope by the delay tells the rest."""
LATEST = 0.5
"""Longest delay that is tried [s]: a hydraulic unit in the cold has 0.2 s."""
EARLIEST = -0.5
"""Largest advance that is tried [s]: nothing brakes before the pressure but by a wrong clock."""
USUAL, SPREAD = 0.02, 0.06
"""Delay of brakes and filters as usual, and its standard deviation [s]: on a slow ramp a delay and
a force are nearly one, and only what is usual tells them apart."""
FORCE = 0.05
"""Standard deviation of the force over the usual brake force before the run [1]."""
GROUP = 0.2
"""Time over which residuals are averaged to see how they are correlated [s]."""
AFTER = 0.5
"""Time after a release that still tells of the brakes [s]; later the engine may drive."""
SLOW = 4.0
"""Speed [m/s] below which nothing is used: the car jerks at standstill."""
LEAST = 1.0
"""Time of braking that is needed [s]."""
AGE = 10.0
"""Time over which the trend is written [s]."""


@dataclass(frozen=True)
class BrakeResponse:
    """Delay of the brakes [s], force without pressure [N], each with its standard deviation.

    ``delay`` is above zero where the deceleration comes after the pressure. ``share`` is ``force``
    over the median demanded brake force [1], ``share_sigma`` its standard deviation.
    """

    delay: float
    delay_sigma: float
    force: float
    force_sigma: float
    share: float
    share_sigma: float


def brake_response(s: Signals, forces: BrakeBalance) -> BrakeResponse | None:
    """Delay and force without pressure of a run; None if it brakes too little to tell."""
    size = max(1, round(STEP / s.sample_time))
    step = size * s.sample_time
    active = forces.active.astype(float)
    time, nominal, demanded, braked, use = (
        block_mean(x, size)
        for x in (
            s.time,
            forces.nominal_f + forces.nominal_r,
            forces.balance.demanded,
            active,
            _useful(s, forces.active).astype(float),
        )
    )
    inside = use == 1.0
    if step * float(braked[inside].sum()) < LEAST:
        return None
    age = (time - float(time[inside].mean())) / AGE

    def columns(kind: str, delay: float) -> Array:
        """What the demanded force is made of, (n, 4)."""
        late, on = (_delayed(time, x, kind, delay) for x in (nominal, braked))
        return np.column_stack([late, late * age, on, np.ones_like(late)])

    y = demanded[inside]
    usual = float(np.median(y[braked[inside] > 0.5]))
    kind, delay = _best(columns, y, inside)
    A = columns(kind, delay)
    slope = (first_order(time, A[:, 0], step) - A[:, 0]) / step  # by the delay
    A = np.column_stack([A, slope])[inside]
    level = float(np.linalg.lstsq(A, y, rcond=None)[0][0])
    if not (level > 0.0 and usual > 0.0):
        return None
    # rows of what is usual: the force around 0, the delay around USUAL
    prior = np.zeros((2, 5))
    prior[0, 2], prior[1, 4] = 1.0 / (FORCE * usual), 1.0 / (SPREAD * level)
    aim = np.array([0.0, (USUAL - delay) / SPREAD])
    noise = np.sqrt(_variance(y - A @ np.linalg.lstsq(A, y, rcond=None)[0]))
    A, y = np.vstack([A / noise, prior]), np.concatenate([y / noise, aim])
    solution = np.linalg.lstsq(A, y, rcond=None)[0]
    sigma = np.sqrt(np.diag(np.linalg.pinv(A.T @ A)))
    return BrakeResponse(
        delay=float(delay) + float(solution[4]) / level,
        delay_sigma=float(sigma[4]) / level,
        force=float(solution[2]),
        force_sigma=float(sigma[2]),
        share=float(solution[2]) / usual,
        share_sigma=float(sigma[2]) / usual,
    )


def _useful(s: Signals, active: Mask) -> Mask:
    """The lead-in, and from the first braking on all that is braked or has just been, (n,)."""
    if not active.any():
        return np.zeros_like(active)
    since = s.time - np.maximum.accumulate(np.where(active, s.time, -np.inf))
    return np.asarray((s.lead_in | (since < AFTER)) & (s.speed > SLOW))


def _delayed(time: Array, x: Array, kind: str, delay: float) -> Array:
    if delay == 0.0:
        return x
    return first_order(time, x, delay) if kind == "lag" else np.interp(time - delay, time, x)


def _best(columns: Columns, y: Array, inside: Mask) -> tuple[str, float]:
    """The most probable kind and delay [s]: the least residual, weighed with what is usual."""
    tried = [("shift", 0.0)]
    tried += [("shift", d) for d in np.arange(EARLIEST, LATEST, TRIED) if abs(d) > 0.5 * TRIED]
    tried += [("lag", d) for d in np.arange(TRIED, LATEST, TRIED)]
    rest = [_residual(columns(kind, delay)[inside], y) for kind, delay in tried]
    best = min(rest, key=lambda r: float(r @ r))
    cost = [float(r @ r) / _variance(best) for r in rest]
    unusual = [((delay - USUAL) / SPREAD) ** 2 for _, delay in tried]
    return tried[int(np.argmin(np.add(cost, unusual)))]


def _residual(A: Array, y: Array) -> Array:
    """What a least-squares fit leaves."""
    return np.asarray(y - A @ np.linalg.lstsq(A, y, rcond=None)[0])


def _variance(residual: Array) -> float:
    """Variance of a residual as if it were white, with its long-run correlation counted."""
    group = round(GROUP / STEP)
    short = float(np.mean(residual**2))
    if residual.size < 4 * group:
        return short
    return max(short, group * float(np.var(block_mean(residual, group))))
