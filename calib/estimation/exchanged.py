"""What a log would say if front and rear wheel speeds were exchanged in it.

    (z, eta - 1) of the braking  against  what each scenario of `calib.fitting.stops` would show

The mean of the likelihoods over the scenarios, of the log as given and of the same with 1/eta: pads
alike or apart, any road, the zero of the day.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from calib.base.arrays import Array
from calib.car.braking import BITE, MOVING
from calib.car.forces import speed_ratio
from calib.estimation.estimator import Estimate
from calib.estimation.zeros import known_slips
from calib.fitting.draws import ensemble_of
from calib.fitting.stops import scenarios, seen
from calib.run.blocks import block_balance

_BINS = np.array([0.05, 0.08, 0.12, 0.17, 0.24, 0.33, 0.45, 0.6, 1.0])
"""Decelerations [1] between which blocks are averaged."""
_COUNT = 4096  # scenarios
_FORM = 0.03  # of eta - 1, relative: forms of tyres, and loads that move late
_FINEST = 5e-5  # least error of a mean of eta - 1 [1]
_ZEROED, _NOT_ZEROED = 5e-5, 0.01  # sigma of the zero of eta [1], with a lead-in and without


@dataclass(frozen=True)
class Exchanged:
    """The log with its axles exchanged against the log as it is.

    ``log_odds`` logarithm of the likelihood of what eta read while braking, exchanged over as given
    [1]; ``log_pad_ratio`` change of the pads' ratio since the ramp that each of them tells [1],
    as given first, with ``sigma`` of that as given.
    """

    log_odds: float
    log_pad_ratio: tuple[float, float]
    sigma: float


def exchanged(e: Estimate) -> Exchanged | None:
    """Weigh a log against itself with its axles exchanged.

    None without draws in the table, or where the car never brakes.
    """
    draws, car = e.plan.table.draws, e.plan.table.vehicle
    if draws is None:
        return None
    z, shift, error = _curve(e)
    if not z.size:
        return None
    s = scenarios(car, ensemble_of(car, draws), _COUNT)
    shown = np.stack([seen(car, s, float(at)).shift for at in z], axis=1)
    zero = _ZEROED if e.read.lead_in.any() else _NOT_ZEROED
    precision = np.asarray(np.linalg.inv(np.diag(error**2) + zero**2), dtype=float)
    given, other = (
        _weighed(one - shown, precision, s.change) for one in (shift, 1.0 / (1.0 + shift) - 1.0)
    )
    return Exchanged(other[0] - given[0], (given[1], other[1]), given[2])


def _curve(e: Estimate) -> tuple[Array, Array, Array]:
    """Demanded brake force over the weight, eta - 1 and its error, means within `_BINS`."""
    b, plan = e.blocks, e.plan
    road = block_balance(plan.nominal, plan.known.effects, b)
    demanded = road.demanded / plan.nominal.weight
    shift = (
        b.eta / speed_ratio(*known_slips(plan.table, plan.table.vehicle, road)) / (1.0 + e.eta_zero)
        - 1.0
    )
    use = (np.maximum(b.p_f, b.p_r) > BITE) & (b.speed > MOVING)
    variance = 2.0 * (plan.noise.omega / np.maximum(b.omega_f, 1.0)) ** 2 / b.length
    rows = []
    for low, high in pairwise(_BINS):
        of = use & (demanded > low) & (demanded <= high)
        if of.any():
            sigma = np.sqrt(np.sum(variance[of])) / np.count_nonzero(of)
            rows.append((np.mean(demanded[of]), np.mean(shift[of]), sigma))
    z, mean, sigma = np.array(rows, dtype=float).reshape(-1, 3).T
    return z, mean, np.sqrt(sigma**2 + (_FORM * mean) ** 2 + _FINEST**2)


def _weighed(rest: Array, precision: Array, change: Array) -> tuple[float, float, float]:
    """ln of the mean likelihood of what is left (n, k); mean and sigma of ``change`` (n,)."""
    log_likelihood = -0.5 * np.einsum("nk,kj,nj->n", rest, precision, rest)
    most = float(np.max(log_likelihood))
    weight = np.exp(log_likelihood - most)
    mean = float(np.average(change, weights=weight))
    sigma = float(np.sqrt(np.average((change - mean) ** 2, weights=weight)))
    return most + float(np.log(np.mean(weight))), mean, sigma
