"""The split between the axles: an extended Kalman filter over everything that is uncertain.

    states and their priors          calib.estimation.states, priors
    what the sensors would show      calib.estimation.measurement
    inputs, measurements, noise      calib.estimation.filter_input
    the loop                         here
    the answer                       calib.estimation.pad_ratio

Measured every block: eta always, the mean slip where v is known. In front of the first braking the
same equations zero eta and the slip.

The table's scatter is considered, not estimated: no gain counts it, so that no stop learns from it,
and every interval does (a Schmidt-Kalman filter: Simon, Optimal State Estimation, section 10.3.2).
Its root A stands beside the covariance and moves as an error does, A <- (I - K H) F A.

Causal; one step a block, of the same length for every block. Not for ABS, for a turn, or beyond the
tyre's peak.
"""

import math
from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.car.vehicle import Vehicle
from calib.estimation.filter_input import (
    Measured,
    SplitInput,
    given,
    lasting_error,
    measured,
    process_noise,
)
from calib.estimation.measurement import (
    Given,
    Sensed,
    axle_loads_now,
    braked,
    coasting,
    measurement,
)
from calib.estimation.pad_ratio import KEPT, PadRatio, RatioStep, weigh
from calib.estimation.priors import Priors
from calib.estimation.states import (
    AT,
    COUNT,
    changed_surface,
    first_scatter,
    first_state,
    open_surface,
)
from calib.model.ramp import form_error
from calib.model.settings import SETTINGS
from calib.run.blocks import Blocks
from calib.run.noise import SensorNoise
from calib.table.table import TyrePosterior

Array = NDArray[np.float64]


def filter_pad_ratio(
    vehicle: Vehicle,
    b: Blocks,
    demand: SplitInput,
    noise: SensorNoise,
    posterior: TyrePosterior,
    priors: Priors,
    steps: list[RatioStep | None] | None = None,
) -> PadRatio:
    """Run the filter over the blocks of a stop, from the table's ``posterior``.

    ``steps`` is a list to fill with what each block did, None for a block that was not measured.
    """
    start, P_0 = first_state(posterior, priors)
    carried = np.column_stack([P_0, first_scatter(posterior), start])
    P, x = carried[:, :COUNT], carried[:, -1]
    x[ETA_ZERO] = vehicle.front.rolling_radius / vehicle.rear.rolling_radius - 1.0
    inputs, readings = given(vehicle, b, demand), measured(b, demand, noise, priors)
    grown = process_noise(vehicle, b, priors)
    decay, lasting = math.exp(-b.length / priors.pitch_memory), lasting_error(b.length, priors)
    count = b.end.size
    kept = _kept(carried.shape[1])
    states, variances = np.empty((count, COUNT)), np.empty((count, kept.size))
    innovation, density = np.full((count, 2), np.nan), np.zeros(count)
    changes: list[float] = []
    bumps: list[tuple[float, float]] = []
    # views of what is carried, taken once: the loop changes it in place and never replaces it
    shift = AT.load_shift
    row_shift, column_shift, flat = carried[shift], P[:, shift], carried.reshape(-1)
    diagonal = flat[:: carried.shape[1] + 1]
    loads, programs = axle_loads_now(), (measurement(coasting), measurement(braked))
    afresh = changed_surface(b.length, priors)
    most = max(math.ceil(priors.wild_time / b.length - 1e-9), 1)
    # blocks not taken in up to now, and the place of the first; innovations on one road
    wild, first = 0, 0
    recent: deque[list[float]] = deque(maxlen=ALIKE)
    for k, (g, reading) in enumerate(zip(inputs, readings, strict=True)):
        row_shift *= decay
        column_shift *= decay
        diagonal += grown[k]
        if changes:
            open_surface(P, priors, afresh)
        step = None
        # with an axle lifted, a_x had a glitch and no load is known
        if reading.known and min(loads(now := x.tolist(), g)[0]) > 0.0:
            braking = g[LEVEL] > 0.0
            predicted = programs[braking](now, g)
            gate = (priors.calm_gate if wild else priors.wild_gate) if braking else math.inf
            opened = bool(braking and reading.calm and _apart(recent, gate))
            if opened:
                first = k - ALIKE
            else:
                density[k], step = _measure(
                    carried, predicted, now, reading, lasting, innovation[k], gate
                )
                if step and wild in range(BUMP, most + 1):
                    bumps.append((float(b.end[max(first - 1, 0)]), float(b.end[k - 1])))
                wild = 0 if step else wild + 1
                if wild == 1:
                    first = k
                opened = wild > most and bool(reading.calm)
            if opened:
                # the road has changed: what was learnt of the pads must not take the blame
                open_surface(P, priors, 1.0)
                changes.append(float(b.end[first]))
                wild = 0
                recent.clear()
            if opened or wild > most:
                # it lasts, so it is no bump
                density[k], step = _measure(
                    carried, predicted, now, reading, lasting, innovation[k], math.inf
                )
            if opened and step:
                density[k] -= priors.wild_gate
                step = step._replace(opened=True)
        if step:
            recent.append(innovation[k].tolist())
        else:
            recent.clear()
        if steps is not None:
            steps.append(step)
        states[k] = x
        flat.take(kept, out=variances[k], mode="clip")
    return weigh(
        states,
        _with_scatter(variances),
        innovation,
        density,
        tuple(changes),
        tuple(bumps),
        demand.odds_by_level,
        priors,
    )


def _kept(width: int) -> NDArray[np.int64]:
    """Places of the entries `KEPT` of P, and of what A has of the two states of each.

    In the flat matrix that has P, A and x beside each other, ``width`` columns.
    """
    A = range(COUNT, width - 1)
    of_A = [row * width + column for pair in KEPT for row in pair for column in A]
    return np.array([one * width + other for one, other in KEPT] + of_A)


def _with_scatter(kept: Array) -> Array:
    """The entries `KEPT` of P + A A' (k, 4), from what `_kept` has placed (k, 4 + 8 m)."""
    n = len(KEPT)
    one, other = np.moveaxis(kept[:, n:].reshape(len(kept), n, 2, -1), 2, 0)
    return np.asarray(kept[:, :n] + np.sum(one * other, axis=2))


def _apart(recent: Sequence[Sequence[float]], gate: float) -> bool:
    """Whether the last `ALIKE` blocks are off the same way.

    The mean square of the sums of their innovations over the sensors is past ``gate`` then.
    """
    if len(recent) < ALIKE:
        return False
    eta, slip = (sum(of) ** 2 / ALIKE for of in zip(*recent, strict=True))
    return bool((eta if math.isnan(slip) else 0.5 * (eta + slip)) > gate)


def _measure(
    carried: Array,
    predicted: Sensed,
    now: list[float],
    reading: Measured,
    lasting: float,
    innovation: Array,
    gate: float,
) -> tuple[float, RatioStep | None]:
    """Take in eta and, where there is one, the slip, if their mean squared innovation is in `gate`.

    Returns the logarithm of the probability density of what was measured, less a constant, and the
    step; None where nothing was taken in, with the density at the gate.

    ``carried`` P, A and x beside each other: with W = whitening H, white = W P and the innovations
    n, P and A become less by white' W P and white' W A, x by white' (-n), which is one product.
    ``predicted`` at ``now``, which is x as plain floats; ``lasting`` as `lasting_error` has it.
    """
    (eta, slip), gradients, near = predicted
    measured_eta, measured_slip, var_eta, var_slip, relative, _, _ = reading
    rows = np.array(gradients).reshape(2, COUNT)
    along = rows.dot(carried)
    (total_eta, both), (_, total_slip) = along[:, :COUNT].dot(rows.T).tolist()
    relative = lasting * math.hypot(relative, min(form_error(max(near)), MOST))
    total_eta += var_eta + (relative * (eta - 1.0 - now[ETA_ZERO])) ** 2
    root = math.sqrt(total_eta)
    first = (measured_eta - eta) / root
    turn = second = scale = 0.0
    if not math.isnan(measured_slip):
        # what eta has not said of the slip
        turn = both / total_eta
        total_slip += var_slip + (relative * (slip - now[SLIP_ZERO])) ** 2 - both * turn
        scale = 1.0 / math.sqrt(total_slip)
        second = (measured_slip - slip - turn * root * first) * scale
    count = 2.0 if scale else 1.0
    square, width = first * first + second * second, math.log((scale or 1.0) / root)
    if square > gate * count:
        return width - 0.5 * gate * count, None
    innovation[0], innovation[1] = first, second if scale else math.nan
    whitening = np.array(((1.0 / root, 0.0), (-turn * scale, scale)))
    moved = whitening.dot(along)
    white = moved[:, :COUNT]
    moved[0, -1], moved[1, -1] = -first, -second
    carried -= white.T.dot(moved)
    return width - 0.5 * square, RatioStep(rows, whitening, white)


MOST = SETTINGS.form_error
"""Most that the form of the tyre's curve is off here, relative to the slip [1]: stiffness and peak
of the surface are states, and follow it. With more nothing would be learnt once they err."""

ALIKE = 4
"""Blocks in a row that show a road which changes too little to be seen in one: 0.2 s."""

BUMP = 2
"""Blocks in a row that were not taken in from which on it is told: one is often noise."""

LEVEL = Given._fields.index("level")
ETA_ZERO, SLIP_ZERO = AT.eta_zero, AT.slip_zero
"""Places that the loop reads itself."""
