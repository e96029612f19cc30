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

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from calib.base.arrays import Array
from calib.car.tyre_forms import FORMS
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import DEPART_AT, PRIORS, Ensemble, spread_evenly
from calib.fitting.regression import Regression
from calib.model.ramp import RampRun
from calib.table.table import Value

DRAWS = 2048
"""Size of the ensemble: its 2.5 % quantile is known to a tenth of a sigma."""

_SPARSE = 0.6  # concentration of the forms' weights: two or three make up most of a tyre
_NONLINEAR = (
    "load_exponent",
    "peak_load_exponent",
    "log_peak",
    "log_pad_ratio",
    "cg_to_front_axle",
    "cg_height",
)
_PRIORS = {"tyres": [*range(8), 11, 12], "unlike_pads": [8], "load_geometry": [9, 10, 13]}
"""Part of a budget of the numbers of a draw: forms, `_NONLINEAR`, compliances, fall of radii."""


@dataclass(frozen=True)
class Posterior(Ensemble):
    """The draws that explain ramps.

    ``pulls`` (n, m) by part of a budget (`calib.table.budget`): by how much ln of the probability
    of a draw grows when an error of that cause grows by one standard deviation. The mean of any x
    then moves by cov(x, pull), and that of all causes is its covariance; see `parts_of`.
    """

    pulls: dict[str, Array]


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
def _amounts() -> tuple[Array, Array]:
    """Standard normal numbers, and ln of the Gamma distributed ones with the same quantiles."""
    from scipy.special import gammaincinv, ndtr

    x = np.linspace(-7.0, 7.0, 2001)
    return x, np.log(gammaincinv(_SPARSE, ndtr(x)))


def _from_normal(x: Array, ratio: Value) -> Ensemble:
    """The prior's draws (n, 5 + 6) from standard normal ones; unit compliances."""
    amount = np.exp(np.interp(x[:, : len(FORMS)], *_amounts()))
    priors = PRIORS | {"log_pad_ratio": (ratio.value, ratio.sigma)}
    drawn = {
        name: priors[name][0] + priors[name][1] * column
        for name, column in zip(_NONLINEAR, x[:, len(FORMS) :].T, strict=True)
    }
    one = np.ones(x.shape[0])
    return Ensemble(
        forms=amount / amount.sum(axis=1, keepdims=True),
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


def posterior(car: Vehicle, runs: list[RampRun], ratio: Value, draws: int = DRAWS) -> Posterior:
    """The ensemble given the ramps ``runs``; ``ratio`` what is known of the pads' ratio before.

    Raises ValueError where no draw of the prior explains the ramps at all, or nothing is left of a
    ramp.
    """
    from scipy.special import ndtri

    regression = Regression(car, runs)
    dimension = len(FORMS) + len(_NONLINEAR)
    rng = np.random.default_rng(40)
    start = ndtri(spread_evenly(draws, dimension))

    def log_evidence(x: Array) -> Array:
        return regression.solve(_from_normal(x, ratio))[0]

    x = _carried(start, log_evidence, rng)
    e = _from_normal(x, ratio)
    _, mean, A = regression.solve(e)
    # precision A = C C': mean + C'^-1 noise has covariance A^-1
    noise = rng.standard_normal(mean.shape)[..., None]
    found = mean + np.linalg.solve(np.linalg.cholesky(A).transpose(0, 2, 1), noise)[..., 0]
    left = regression.left(e, found) @ regression.white.T
    departs = regression.departures(left)
    front, rear = np.maximum(found[:, :2].T, 0.1 * PRIORS["compliance"][0])
    before = np.hstack([x, (found - regression.start) @ np.linalg.cholesky(regression.precision)])
    pulls = regression.pulls(left)
    for part, columns in _PRIORS.items():
        pulls[part] = np.hstack([pulls.get(part, before[:, :0]), before[:, columns]])
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
