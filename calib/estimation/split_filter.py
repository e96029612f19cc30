"""The split between the axles: an extended Kalman filter over everything that is uncertain.

    states and their priors          calib.estimation.states, priors
    what the sensors would show      calib.estimation.measurement
    inputs, measurements, noise      calib.estimation.filter_input
    the loop                         here
    the answer                       calib.estimation.pad_ratio

Measured every block: eta always, the mean slip where v is known. In front of the first braking the
same equations zero eta and the slip.

Causal; one step a block, of the same length for every block. Not for ABS, for a turn, or beyond the
tyre's peak.
"""

import math

import numpy as np
from numpy.typing import NDArray

from calib.estimation.filter_input import Measured, SplitInput, given, measured, process_noise
from calib.estimation.measurement import (
    Given,
    Sensed,
    axle_loads_now,
    braked,
    coasting,
    measurement,
)
from calib.estimation.pad_ratio import KEPT, PadRatio, Step, weigh
from calib.estimation.priors import Priors
from calib.estimation.states import AT, COUNT, first_state, open_surface
from calib.physics.vehicle import Vehicle
from calib.signals.blocks import Blocks
from calib.signals.noise import SensorNoise
from calib.table.table import TyrePosterior

Array = NDArray[np.float64]


def filter_pad_ratio(
    vehicle: Vehicle,
    b: Blocks,
    demand: SplitInput,
    noise: SensorNoise,
    posterior: TyrePosterior,
    priors: Priors,
    steps: list[Step | None] | None = None,
) -> PadRatio:
    """Run the filter over the blocks of a stop, from the table's ``posterior``.

    ``steps`` is a list to fill with what each block did, None for a block that was not measured.
    """
    x, P = first_state(posterior, priors)
    x[ETA_ZERO] = vehicle.front.rolling_radius / vehicle.rear.rolling_radius - 1.0
    inputs, readings = given(vehicle, b, demand), measured(b, demand, noise, priors)
    grown = process_noise(vehicle, b, priors)
    decay = math.exp(-b.length / priors.pitch_memory)
    count = b.end.size
    states, variances = np.empty((count, COUNT)), np.empty((count, len(KEPT)))
    innovation, density = np.full((count, 2), np.nan), np.zeros(count)
    changes: list[float] = []
    # views of P, taken once: the loop changes P in place and never replaces it
    shift = AT.load_shift
    row_shift, column_shift, flat = P[shift], P[:, shift], P.reshape(-1)
    diagonal = flat[:: COUNT + 1]
    before_x, before_P = np.empty_like(x), np.empty_like(P)
    loads, programs = axle_loads_now(), (measurement(coasting), measurement(braked))
    pause = 0
    for k, (g, reading) in enumerate(zip(inputs, readings, strict=True)):
        x[shift] *= decay
        row_shift *= decay
        column_shift *= decay
        diagonal += grown[k]
        # with an axle lifted, a_x had a glitch and no load is known
        if reading.known and min(loads(now := x.tolist(), g)[0]) > 0.0:
            pause = max(pause - 1, 0)
            braking = g[LEVEL] > 0.0
            alert = braking and reading.calm and pause == 0
            if alert:
                before_x[:], before_P[:] = x, P
            predicted = programs[braking](now, g)
            surprise, density[k], step = _measure(x, P, predicted, now, reading, innovation[k])
            opened = bool(alert and surprise > priors.change_gate)
            if opened:
                # the road has changed: what was learnt of the pads must not take the blame
                x[:], P[:] = before_x, before_P
                open_surface(P, priors)
                _, density[k], step = _measure(x, P, predicted, now, reading, innovation[k])
                density[k] -= priors.change_gate
                changes.append(float(b.end[k]))
                pause = priors.change_pause
            if steps is not None:
                steps.append(Step(*step, opened))
        elif steps is not None:
            steps.append(None)
        states[k] = x
        variances[k] = flat[KEPT]
    return weigh(states, variances, innovation, density, tuple(changes), priors)


def _measure(
    x: Array,
    P: Array,
    predicted: Sensed,
    now: list[float],
    reading: Measured,
    innovation: Array,
) -> tuple[float, float, tuple[Array, Array, Array]]:
    """Take in eta and, where there is one, the slip; return the mean squared innovation.

    Beside it the logarithm of the probability density of what was measured, less a constant, and
    rows, whitening and white of a `Step`.

    ``predicted`` eta, slip and their gradients at ``now``, which is x as plain floats.
    """
    (eta, slip), gradients = predicted
    measured_eta, measured_slip, var_eta, var_slip, relative, _, _ = reading
    rows = np.array(gradients).reshape(2, COUNT)
    along = rows.dot(P)
    (total_eta, both), (_, total_slip) = along.dot(rows.T).tolist()
    total_eta += var_eta + (relative * (eta - 1.0 - now[ETA_ZERO])) ** 2
    root = math.sqrt(total_eta)
    first = innovation[0] = (measured_eta - eta) / root
    turn = second = scale = 0.0
    if not math.isnan(measured_slip):
        # what eta has not said of the slip
        turn = both / total_eta
        total_slip += var_slip + (relative * (slip - now[SLIP_ZERO])) ** 2 - both * turn
        scale = 1.0 / math.sqrt(total_slip)
        second = innovation[1] = (measured_slip - slip - turn * root * first) * scale
    whitening = np.array(((1.0 / root, 0.0), (-turn * scale, scale)))
    white = whitening.dot(along)
    x += np.array((first, second)).dot(white)
    P -= white.T.dot(white)
    square = first * first + second * second
    density = math.log((scale or 1.0) / root) - 0.5 * square
    return square / (2.0 if scale else 1.0), density, (rows, whitening, white)


LEVEL = Given._fields.index("level")
ETA_ZERO, SLIP_ZERO = AT.eta_zero, AT.slip_zero
"""Places that the loop reads itself."""
