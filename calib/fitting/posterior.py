r"""The ensemble that explains the ramps.

    prior --> forces over loads --tyre forms--> slips --(22)--> eta, and slip where v is logged

The evidence of `calib.fitting.regression`, and of what a user states of the pads' ratio, carries
the draws from prior to posterior in steps of equal loss (sequential Monte Carlo, Del Moral et al.
2006, doi:10.1111/j.1467-9868.2006.00553.x), with moves in between that leave the prior as it is
(preconditioned Crank-Nicolson, Cotter et al. 2013, doi:10.1214/13-STS421).
The sequence of draws is fixed: the same logs give the same table.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, spread_evenly
from calib.fitting.known import COMPLIANCE, OF, OWN, Known, drawn, log_more, part_of
from calib.fitting.pads import UNSAID
from calib.fitting.regression import Regression
from calib.model.ramp import RampRun
from calib.table.table import Value

_DRAWS = 2048  # of an ensemble: its 2.5 % quantile is known to a tenth of a sigma
_TYRES = ("form", "load_exponent", "peak_load_exponent", "peak", "compliance", "log_tyre_ratio")
_CAUSES = {
    "tyres": _TYRES,
    "unlike_pads": ("log_pad_ratio",),
    "load_geometry": ("cg_to_front_axle", "cg_height", "radius_load"),
}
"""Coordinates of the prior by part of a budget."""

_LOSS = 0.5  # share of the draws that count after a step
_STRIDE = 0.4  # of a move
_MOVES, _MOST_MOVES = 0.8, 6  # accepted moves of a draw between two steps, and tries


@dataclass(frozen=True)
class Posterior(Ensemble):
    """The draws that explain ramps.

    ``pulls`` (n, m) by part of a budget (`calib.table.budget`): by how much ln of the probability
    of a draw grows when an error of that cause grows by one standard deviation. The mean of any x
    then moves by cov(x, pull), and that of all causes is its variance; see `parts_of`.
    ``held`` (k,) how likely what was known before is to hold for this car, each of it against the
    field alone, at even odds before the ramps [1]. ``misfit`` root mean square of what the draws
    leave of eta and slip, over the errors of sensors and form [1].
    """

    pulls: dict[str, Array]
    misfit: float
    held: Array

    def thinned(self, step: int) -> "Posterior":
        """Each ``step``-th draw, with its pulls."""
        which = slice(None, None, step)
        pulls = {part: pull[which] for part, pull in self.pulls.items()}
        return replace(self, **vars(Ensemble.take(self, which)), pulls=pulls)


def parts_of(x: Array, pulls: Mapping[str, Array]) -> dict[str, Array]:
    """Variance (k,) of each of ``x`` (k, n), functions of the draws, by the cause of the error.

    Each cause moves the mean of x by cov(x, pull). That is exact where all is normal and linear;
    elsewhere the parts are scaled so that they add up to the variance of the draws.
    """
    off = x - np.mean(x, axis=1, keepdims=True)
    moved = {part: np.sum((off @ pull) ** 2, axis=1) for part, pull in pulls.items()}
    whole = np.sum([*moved.values()], axis=0)
    scale = np.divide(np.var(x, axis=1), whole, out=np.zeros(len(x)), where=whole > 0.0)
    return {part: scale * by for part, by in moved.items()}


def posterior(
    car: Vehicle,
    runs: list[RampRun],
    ratio: Value,
    draws: int = _DRAWS,
    known: Sequence[Known] = (),
) -> Posterior:
    """The ensemble given the ramps ``runs``; ``ratio`` what is stated of ln of the pads' ratio.

    `UNSAID` where nobody states it. What else is ``known`` shares half of the prior. Raises
    ValueError where no draw of the prior explains the ramps at all, or nothing is left of a ramp.
    """
    from scipy.special import ndtri

    regression, rng = Regression(car, runs), np.random.default_rng(40)

    def log_evidence(x: Array) -> Array:
        e, *of_linear = drawn(x, known)
        more = log_more(ratio, e.log_pad_ratio) if ratio != UNSAID else 0.0
        return regression.solve(e, *of_linear)[0] + more

    start = ndtri(spread_evenly(draws, OWN + bool(known)))
    x = _carried(start, log_evidence, rng)
    e, centre, root = drawn(x, known)
    _, mean, A = regression.solve(e, centre, root)
    # precision A = C C': mean + C'^-1 noise has covariance A^-1
    noise = rng.standard_normal(mean.shape)[..., None]
    found = mean + np.linalg.solve(np.linalg.cholesky(A).transpose(0, 2, 1), noise)[..., 0]
    linear = centre + np.einsum("nij,nj->ni", root, found)
    front, rear = np.maximum(linear[:, :2].T, 0.1 * COMPLIANCE)
    e = replace(e, compliance_f=front, compliance_r=rear, radius_load=linear[:, 2])
    left = regression.left(e) @ regression.white.T
    before = np.hstack([x[:, :OWN], found])
    if ratio != UNSAID:
        unlike = (e.log_pad_ratio - ratio.value) / ratio.sigma
        before[:, OF["log_pad_ratio"]] = unlike[:, None]
    pulls = {part: left @ (regression.white @ x) for part, x in regression.errors.items()}
    for part, names in _CAUSES.items():
        own = [before[:, OF[name]] for name in names]
        pulls[part] = np.hstack([pulls.get(part, before[:, :0]), *own])
    field, *others = np.bincount(part_of(x, known), minlength=len(known) + 1)
    counts = len(known) * np.array(others, dtype=np.float64)
    return Posterior(
        **vars(e) | regression.beside(left, rng),
        pulls=pulls,
        misfit=float(np.sqrt(np.mean(left**2))),
        held=(counts + 0.5) / (counts + field + 1.0),
    )


def _carried(x: Array, log_evidence: Callable[[Array], Array], rng: np.random.Generator) -> Array:
    """Draws ``x`` (n, d) of a standard normal carried to the posterior."""
    log, power = log_evidence(x), 0.0
    if not np.any(np.isfinite(log)):
        raise ValueError("no draw of the prior explains the ramps")
    while power < 1.0:
        step = _step(log, 1.0 - power)
        share = np.cumsum(np.exp(step * (log - log.max())))
        at = np.searchsorted(share / share[-1], (np.arange(log.size) + rng.random()) / log.size)
        x, log, power = x[at], log[at], power + step
        moved = 0.0
        for _ in range(_MOST_MOVES):
            other = np.sqrt(1.0 - _STRIDE**2) * x + _STRIDE * rng.standard_normal(x.shape)
            better = log_evidence(other)
            take = np.log(rng.random(log.size)) < power * (better - log)
            x, log = np.where(take[:, None], other, x), np.where(take, better, log)
            moved += float(np.mean(take))
            if moved > _MOVES:
                break
    return x


def _step(log: Array, most: float) -> float:
    """Power of the evidence after which the share `_LOSS` of the draws counts, at most ``most``."""
    low, high = 0.0, 2.0 * most  # the first that is tried is the most
    for _ in range(41):
        power = min(0.5 * (low + high), most)
        weight = np.exp(power * (log - log.max()))
        counting = weight.sum() ** 2 / (weight @ weight) / log.size
        low, high = (power, high) if counting >= _LOSS else (low, power)
    return min(high, most)
