r"""The ensemble that explains the ramps.

    prior --> forces over loads --tyre forms--> slips --(22)--> eta, and slip where v is logged

Forms, load exponents, peak, pads' ratio and centre of gravity enter nonlinearly. Given them, a
Gaussian regression gives compliances and fall of the radii, and the evidence of the rest; see
`calib.fitting.regression`.

The evidence carries the draws from prior to posterior in steps of equal loss (sequential Monte
Carlo, Del Moral et al. 2006, doi:10.1111/j.1467-9868.2006.00553.x), with moves in between that
leave the prior as it is (preconditioned Crank-Nicolson, Cotter et al. 2013, doi:10.1214/13-STS421).
The sequence of draws is fixed: the same logs give the same table.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from calib.base.arrays import Array, Index
from calib.car.tyre_forms import FORMS
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import DEPART_AT, PRIORS, Ensemble, spread_evenly
from calib.fitting.known import LINEAR, NONLINEAR, OWN, TO_LINEAR, Known, weights_of
from calib.fitting.pads import UNSAID
from calib.fitting.regression import LinearPrior, Regression
from calib.model.ramp import RampRun
from calib.table.table import Value

_OTHER, _APART = 0.1, 4.3  # cars with pads of another grade or a fault; 0.3 in ln of the ratio
DRAWS = 2048
"""Size of the ensemble: its 2.5 % quantile is known to a tenth of a sigma."""

_PRIORS = {"tyres": [*range(8), 11, 12], "unlike_pads": [8], "load_geometry": [9, 10, 13]}
"""Part of a budget of the numbers of a draw: forms, `NONLINEAR`, compliances, fall of radii."""


@dataclass(frozen=True)
class Posterior(Ensemble):
    """The draws that explain ramps.

    ``pulls`` (n, m) by part of a budget (`calib.table.budget`): by how much ln of the probability
    of a draw grows when an error of that cause grows by one standard deviation. The mean of any x
    then moves by cov(x, pull), and that of all causes is its covariance; see `parts_of`.
    ``held`` (k,) how likely what was known before is to hold for this car, each of it against the
    field alone, at even odds before the ramps [1]. ``misfit`` root mean square of what the draws
    leave of eta and slip, over the errors of sensors and form [1].
    """

    pulls: dict[str, Array]
    misfit: float
    held: Array


def parts_of(x: Array, e: Posterior) -> dict[str, Array]:
    """Covariance (k, k) of ``x`` (k, n), a function of the draws, by the cause of the error.

    Each cause moves the mean of x by cov(x, pull). That is exact where all is normal and linear;
    elsewhere the parts are stretched so that they add up to the covariance of the draws.
    """
    sigma = np.std(x, axis=1, keepdims=True)
    unit = (x - np.mean(x, axis=1, keepdims=True)) / np.where(sigma > 0.0, sigma, 1.0)
    moved = {part: unit @ (pull - pull.mean(axis=0)) / e.size for part, pull in e.pulls.items()}
    parts = {part: by @ by.T for part, by in moved.items()}
    whole = _even_root(unit @ unit.T / e.size)
    stretch = sigma * (whole @ np.linalg.pinv(_even_root(np.sum(list(parts.values()), axis=0))))
    return {part: stretch @ of @ stretch.T for part, of in parts.items()}


def _even_root(covariance: Array) -> Array:
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)) @ vectors.T)


@cache
def _tails() -> tuple[Array, Array]:
    """Standard normal numbers, and those of the pads' ratio with the same quantiles.

    Some cars have other pads than the file says, or a fault: `_OTHER` of them, `_APART` as far.
    """
    from scipy.special import ndtr, ndtri

    r = np.linspace(-9.0, 9.0, 2001)
    below = (1.0 - _OTHER) * ndtr(r) + _OTHER * ndtr(r / _APART)
    return ndtri(np.clip(below, 1e-15, 1.0 - 1e-15)), r


def _from_normal(x: Array, ratio: Value) -> Ensemble:
    """The prior's draws (n, 5 + 6) from standard normal ones; unit compliances."""
    priors = PRIORS | {"log_pad_ratio": (ratio.value, ratio.sigma)}
    columns = dict(zip(NONLINEAR, x[:, len(FORMS) :].T, strict=True))
    if ratio == UNSAID:
        columns["log_pad_ratio"] = np.interp(columns["log_pad_ratio"], *_tails())
    drawn = {name: priors[name][0] + priors[name][1] * of for name, of in columns.items()}
    one = np.ones(x.shape[0])
    return Ensemble(
        forms=weights_of(x[:, : len(FORMS)]),
        load_exponent=drawn["load_exponent"],
        peak_load_exponent=drawn["peak_load_exponent"],
        peak=np.exp(drawn["log_peak"]),
        log_pad_ratio=drawn["log_pad_ratio"],
        cg_to_front_axle=np.exp(drawn["cg_to_front_axle"]),
        cg_height=np.exp(drawn["cg_height"]),
        compliance_f=one,
        compliance_r=one,
        radius_load=one,
        v_late=0.0 * one,
        depart_eta=np.zeros((one.size, DEPART_AT.size)),
        depart_slip=np.zeros((one.size, DEPART_AT.size)),
    )


class _Mixture:
    """The prior as a map of standard normal numbers: the field's, and half of it what is known."""

    def __init__(self, known: Sequence[Known], ratio: Value) -> None:
        self.ratio, self.dimension = ratio, OWN + bool(known)
        self.parts = [one.with_ratio(ratio) for one in known]

    def of(self, x: Array) -> Index:
        """Which part each draw is of, (n,): 0 the field, then what is known in its order."""
        from scipy.special import ndtr

        if not self.parts:
            return np.zeros(x.shape[0], dtype=np.int64)
        above = (2.0 * ndtr(x[:, -1]) - 1.0) * len(self.parts)
        return np.asarray(np.ceil(np.clip(above, 0.0, len(self.parts))), dtype=np.int64)

    def drawn(self, x: Array) -> tuple[Ensemble, LinearPrior]:
        """Draws (n,) of normal numbers (n, d), with the prior of their linear parameters."""
        which, y, field = self.of(x), x[:, :OWN].copy(), np.linalg.inv(TO_LINEAR @ TO_LINEAR.T)
        precision, pull = np.tile(field, (len(x), 1, 1)), np.tile(field @ LINEAR, (len(x), 1))
        log = np.zeros(len(x))
        for i, (mean, covariance, weight) in enumerate(self.parts, 1):
            at, root = which == i, np.linalg.cholesky(covariance)
            moved = mean + x[at, :OWN] @ root[:, :OWN].T
            y[at], linear = moved[:, :OWN], LINEAR + moved[:, OWN:] @ TO_LINEAR.T
            left, narrower = TO_LINEAR @ root[OWN:, OWN:], np.diag(root)[OWN:]
            own = np.linalg.inv(left @ left.T)
            precision[at], pull[at] = own, linear @ own
            square = np.einsum("np,np->n", pull[at], linear) - LINEAR @ field @ LINEAR
            log[at] = weight - np.log(narrower).sum() - 0.5 * square
        return _from_normal(y, self.ratio), LinearPrior(precision, pull, log)


def posterior(
    car: Vehicle,
    runs: list[RampRun],
    ratio: Value,
    draws: int = DRAWS,
    known: Sequence[Known] = (),
) -> Posterior:
    """The ensemble given the ramps ``runs``; ``ratio`` what is known of the pads' ratio before.

    What else is ``known`` shares half of the prior. Raises ValueError where no draw of the prior
    explains the ramps at all, or nothing is left of a ramp.
    """
    from scipy.special import ndtri

    regression = Regression(car, runs)
    prior = _Mixture(known, ratio)
    rng = np.random.default_rng(40)
    start = ndtri(spread_evenly(draws, prior.dimension))

    def log_evidence(x: Array) -> Array:
        return regression.solve(*prior.drawn(x))[0]

    x = _carried(start, log_evidence, rng)
    e, of_linear = prior.drawn(x)
    _, mean, A = regression.solve(e, of_linear)
    # precision A = C C': mean + C'^-1 noise has covariance A^-1
    noise = rng.standard_normal(mean.shape)[..., None]
    found = mean + np.linalg.solve(np.linalg.cholesky(A).transpose(0, 2, 1), noise)[..., 0]
    left = regression.left(e, found) @ regression.white.T
    departs = regression.departures(left)
    front, rear = np.maximum(found[:, :2].T, 0.1 * PRIORS["compliance"][0])
    before = np.hstack([x[:, :OWN], of_linear.standard(found)])
    pulls = regression.pulls(left)
    for part, columns in _PRIORS.items():
        pulls[part] = np.hstack([pulls.get(part, before[:, :0]), before[:, columns]])
    field, *others = np.bincount(prior.of(x), minlength=len(known) + 1)
    counts = len(known) * np.array(others, dtype=np.float64)
    return Posterior(
        **{
            **vars(e),
            "compliance_f": front,
            "compliance_r": rear,
            "radius_load": found[:, 2],
            "v_late": regression.late(left, rng),
            "depart_eta": departs["eta"],
            "depart_slip": departs["slip"],
            "pulls": pulls,
            "misfit": float(np.sqrt(np.mean(left**2))),
            "held": (counts + 0.5) / (counts + field + 1.0),
        }
    )


_LOSS = 0.5  # share of the draws that count after a step
_STRIDE = 0.4  # of a move
_MOVES, _MOST_MOVES = 0.8, 6  # accepted moves of a draw between two steps, and tries


def _carried(x: Array, log_evidence: Callable[[Array], Array], rng: np.random.Generator) -> Array:
    """Draws ``x`` (n, d) of a standard normal carried to the posterior."""
    log, power = log_evidence(x), 0.0
    if not np.any(np.isfinite(log)):
        raise ValueError("no draw of the prior explains the ramps")
    while power < 1.0:
        step = _step(log, 1.0 - power)
        weight = np.exp(step * (log - log.max()))
        at = np.searchsorted(
            np.cumsum(weight) / weight.sum(), (np.arange(log.size) + rng.random()) / log.size
        )
        at = np.minimum(at, log.size - 1)
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

    def counting(power: float) -> float:
        weight = np.exp(power * (log - log.max()))
        return float(weight.sum() ** 2 / (weight @ weight) / log.size)

    if counting(most) >= _LOSS:
        return most
    low, high = 0.0, most
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if counting(middle) >= _LOSS else (low, middle)
    return high
