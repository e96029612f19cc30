"""Whether the wheel speeds of a stop are in their columns.

    (z, eta - 1) of the braking  against  what each scenario of `calib.fitting.stops` would show

The mean of the likelihoods over the scenarios (pads alike or apart, weak ones too, any road, the
zero of the day), of eta as given and of 1/eta, as with exchanged axles. A front wheel that has
changed places with the rear one of the other side leaves eta flat and the sides apart, see
`calib.run.wheels`; those of one side are refused before a stop is estimated.
"""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from calib.base.arrays import Array
from calib.base.warning import Measured
from calib.car.braking import BITE, MOVING
from calib.estimation.estimator import Estimate
from calib.estimation.reasons import Reason
from calib.fitting.ensemble import ensemble_of
from calib.fitting.stops import scenarios, seen
from calib.run.blocks import braked_alone
from calib.run.wheels import WheelParts, crossed_diagonal
from calib.table.table import Table

_BINS = np.array([0.05, 0.08, 0.12, 0.17, 0.24, 0.33, 0.45, 0.6, 1.0])
"""Decelerations [1] between which blocks are averaged."""
_Z = np.geomspace(_BINS[0], _BINS[-1], 25)
"""Decelerations [1] between which scenarios are linear: near its peak a tyre is not for long."""
_COUNT = 4096  # of scenarios
_FORM = 0.03  # of eta - 1, relative: forms of tyres, and loads that move late
_FINEST = 5e-5  # least error of a mean of eta - 1 [1]
_ZEROED, _NOT_ZEROED = 5e-5, 0.01  # sigma of the zero of eta [1], with a lead-in and without


def exchanged(e: Estimate, parts: WheelParts | None) -> Iterator[Measured]:
    """Columns of a log that fit better the other way round; ``parts`` of its wheels."""
    table = e.table
    yield Measured("axles_exchanged", axles_exchanged(table, e))
    if parts is not None:
        expected = float(np.interp(parts.z, table.paper.z, table.paper.eta)) - 1.0
        if crossed := crossed_diagonal(parts, expected):
            yield Measured("wheels_crossed", crossed.part, words={"found": crossed})


def axles_exchanged(table: Table, e: Estimate) -> float:
    """Logarithm of the likelihood of eta with the axles exchanged over that as given.

    0 where the car never brakes, or brakes with the rear axle alone.
    """
    z, shift, error = _curve(e)
    if not z.size or braked_alone(e.blocks.p_f, e.blocks.p_r) == "r":
        return 0.0
    shown = _shown(table) @ np.stack([np.interp(z, _Z, hat) for hat in np.eye(_Z.size)])
    zero = _ZEROED if e.read.lead_in.any() else _NOT_ZEROED
    whiten = np.linalg.cholesky(np.linalg.inv(np.diag(error**2) + zero**2))
    given, other = (
        np.logaddexp.reduce(-0.5 * np.sum(((x - shown) @ whiten) ** 2, axis=1))
        for x in (shift, 1.0 / (1.0 + shift) - 1.0)
    )
    return float(other - given)


@lru_cache(maxsize=2)  # a batch has one table
def _shown(table: Table) -> Array:
    """Eta - 1 that stops with a table's car would show at `_Z` [1], (n, k)."""
    car = table.vehicle
    stops = scenarios(car, ensemble_of(car, table.draws), _COUNT)
    return seen(car, stops, _Z).shift


def _curve(e: Estimate) -> tuple[Array, Array, Array]:
    """Demanded brake force over the weight, eta - 1 and its error, means within `_BINS`.

    Without wheels at their limit, which no scenario has.
    """
    b, demanded = e.blocks, e.best.given.demand
    shift = (1.0 + e.best.given.eta_less_1) / e.zeros[0] - 1.0
    variance = 2.0 * (e.noise.omega / np.maximum(b.omega_f, 1.0)) ** 2 / b.length
    rolls = ~np.isin(e.best.given.disturbed, (Reason.LOCKED, Reason.FAULT))
    use = (np.maximum(b.p_f, b.p_r) > BITE) & (b.speed > MOVING) & rolls
    use &= (demanded > _BINS[0]) & (demanded <= _BINS[-1])
    between = np.digitize(demanded[use], _BINS, right=True)
    _, place, count = np.unique(between, return_inverse=True, return_counts=True)
    z, mean, spread = (np.bincount(place, x[use]) / count for x in (demanded, shift, variance))
    return z, mean, np.sqrt(spread / count + (_FORM * mean) ** 2 + _FINEST**2)
