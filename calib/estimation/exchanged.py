"""Whether the wheel speeds of a stop are in their columns.

    (z, eta - 1) of the braking  against  what each scenario of `calib.fitting.stops` would show

The mean of the likelihoods over the scenarios, of the log as given and of the same with its axles
exchanged, 1/eta: pads alike or apart, any road, the zero of the day. Front pads that are weak, or a
car near ideal balance, are among the scenarios. A front wheel that has changed places with the rear
one of the other side leaves eta flat and the sides apart, see `calib.run.wheels`; those of one side
are refused before a stop is estimated.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from calib.base.arrays import Array
from calib.base.warning import PlausibilityWarning, warning
from calib.car.braking import BITE, MOVING
from calib.car.forces import speed_ratio
from calib.estimation.estimator import Estimate
from calib.estimation.known import known_slips
from calib.estimation.reasons import Reason
from calib.fitting.ensemble import ensemble_of
from calib.fitting.stops import scenarios, seen
from calib.run.blocks import braked_alone
from calib.run.filters import block_mean
from calib.run.limits import LIMITS
from calib.run.wheels import WheelParts, crossed_diagonal

SURE = 5.0
"""Logarithm of the odds of exchanged axles from which no sample is valid: 150 to 1. Weak front pads
and light braking on any road have none above 0, swapped logs of cars as they are 10 and more."""
_BINS = np.array([0.05, 0.08, 0.12, 0.17, 0.24, 0.33, 0.45, 0.6, 1.0])
"""Decelerations [1] between which blocks are averaged."""
_COUNTS = (512, 4096)  # scenarios; the first tell enough where they explain the log as it is
_EXPLAINED, _FAR = -12.0, -20.0  # logarithms of such a likelihood, and of odds that are enough
_FORM = 0.03  # of eta - 1, relative: forms of tyres, and loads that move late
_FINEST = 5e-5  # least error of a mean of eta - 1 [1]
_ZEROED, _NOT_ZEROED = 5e-5, 0.01  # sigma of the zero of eta [1], with a lead-in and without


@dataclass(frozen=True)
class Exchanged:
    """Columns that are likelier the other way round: which ``wheels``, and whether that is sure."""

    wheels: str
    sure: bool
    warning: PlausibilityWarning


def exchanged(log: str, e: Estimate, parts: WheelParts | None) -> Iterator[Exchanged]:
    """Columns of a log that fit better exchanged; ``parts`` of its wheels as observed."""
    odds = axles_exchanged(e)
    if odds is not None and odds > 0.0:
        told = warning("axles_exchanged", log, odds, (None, 0.0))
        yield Exchanged("front and rear", odds > SURE, told)
    paper = e.table.paper
    expected = 0.0 if parts is None else float(np.interp(parts.z, paper.z, paper.eta)) - 1.0
    crossed = crossed_diagonal(parts, expected)
    if parts is not None and crossed is not None:
        least = LIMITS.crossed_least * parts.z
        told = warning("wheels_crossed", log, crossed.part, (-least, least), found=crossed)
        yield Exchanged(" and ".join(crossed.wheels), True, told)


def axles_exchanged(e: Estimate) -> float | None:
    """Logarithm of the likelihood of eta with the axles exchanged over that as given.

    None without draws in the table, where the car never brakes, or brakes with the rear axle alone.
    """
    draws, car = e.table.draws, e.table.vehicle
    z, shift, error = _curve(e)
    if draws is None or not z.size or braked_alone(e.blocks.p_f, e.blocks.p_r) == "r":
        return None
    ensemble = ensemble_of(car, draws)
    zero = _ZEROED if e.read.lead_in.any() else _NOT_ZEROED
    precision = np.asarray(np.linalg.inv(np.diag(error**2) + zero**2), dtype=float)
    odds = 0.0
    for count in _COUNTS:
        s = scenarios(car, ensemble, count)
        shown = np.stack([seen(car, s, float(at)).shift for at in z], axis=1)
        given, other = (_evidence(x - shown, precision) for x in (shift, 1.0 / (1.0 + shift) - 1.0))
        odds = other - given
        if given > _EXPLAINED and odds < _FAR:
            break
    return odds


def _curve(e: Estimate) -> tuple[Array, Array, Array]:
    """Demanded brake force over the weight, eta - 1 and its error, means within `_BINS`.

    Without wheels at their limit, which no scenario has.
    """
    b = e.blocks
    demanded = e.road.demanded / e.car.weight
    known = speed_ratio(*known_slips(e.table, e.road))
    shift = b.eta / known / (1.0 + e.eta_zero) - 1.0
    rolls = block_mean((e.best.step.reason == Reason.LOCKED).astype(float), b.samples) == 0.0
    use = (np.maximum(b.p_f, b.p_r) > BITE) & (b.speed > MOVING) & rolls
    variance = 2.0 * (e.noise.omega / np.maximum(b.omega_f, 1.0)) ** 2 / b.length
    rows = []
    for low, high in pairwise(_BINS):
        of = use & (demanded > low) & (demanded <= high)
        if of.any():
            sigma = np.sqrt(np.sum(variance[of])) / np.count_nonzero(of)
            rows.append((np.mean(demanded[of]), np.mean(shift[of]), sigma))
    z, mean, sigma = np.array(rows, dtype=float).reshape(-1, 3).T
    return z, mean, np.sqrt(sigma**2 + (_FORM * mean) ** 2 + _FINEST**2)


def _evidence(rest: Array, precision: Array) -> float:
    """Logarithm of the mean likelihood of what is left (n, k)."""
    log_likelihood = -0.5 * np.einsum("nk,kj,nj->n", rest, precision, rest)
    most = float(np.max(log_likelihood))
    return most + float(np.log(np.mean(np.exp(log_likelihood - most))))
