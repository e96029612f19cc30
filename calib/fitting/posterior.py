"""The posterior: draws of a car that explain its ramps.

Tempered sequential Monte Carlo (Del Moral et al. 2006, doi:10.1111/j.1467-9868.2006.00553.x)
carries the draws from the prior to the posterior. The likelihood is that of
`calib.fitting.regression` times the user's prior of the pads' ratio; it enters in steps of equal
effective sample size. Between the steps, preconditioned Crank-Nicolson moves keep the prior
invariant (Cotter et al. 2013, doi:10.1214/13-STS421). The random numbers are fixed: the same logs
give the same table.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array, Index
from calib.car.beliefs import CAR
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, spread_evenly
from calib.fitting.pads import DEFAULT_PRIOR
from calib.fitting.prior import DRAWN, PLACES, Prior, draw_cars, log_importance, prior_index
from calib.fitting.regression import Regression
from calib.model.ramp import RampRun
from calib.table.table import Value

_DRAWS = 2048  # they give the 2.5 % quantile to a tenth of a standard deviation
_TYRES = ("form", "load_exponent", "peak_load_exponent", "peak", "compliance", "log_tyre_ratio")
_COORDINATES = {
    "tyres": _TYRES,
    "unlike_pads": ("log_pad_ratio",),
    "load_geometry": ("cg_to_front_axle", "cg_height", "radius_load"),
}
"""Names of the coordinates of the prior that belong to each part of a budget."""

_ESS_FRACTION = 0.5  # effective sample size after a step, over the number of draws
_PCN_STEP = 0.4  # share of new noise in a Crank-Nicolson move
_ACCEPTED_MOVES = 0.8  # accepted moves of a draw at which a step ends, as mean over the draws
_MOST_MOVES = 6  # largest number of tried moves in a step


@dataclass(frozen=True)
class Posterior(Ensemble):
    """Draws that explain the ramps, with figures for budget and warnings."""

    pulls: dict[str, Array]
    """By part of a budget, (n, m): derivative of ln of a draw's probability by each of m errors, in
    standard deviations. An error of one standard deviation changes the mean of a function x of the
    draws by cov(x, pull)."""
    misfit: float  # rms of the residuals of eta and slip over their errors [1]
    prior_support: Array
    """Posterior probability of each informative prior over the default one, at even odds (k,)."""

    def take_with_pulls(self, rows: Index | slice) -> "Posterior":
        """Return the draws of these ``rows``, with their ``pulls``."""
        pulls = {part: pull[rows] for part, pull in self.pulls.items()}
        return replace(self, **vars(Ensemble.take(self, rows)), pulls=pulls)


def parts_of(x: Array, pulls: Mapping[str, Array]) -> dict[str, Array]:
    """Return the variance (k,) of functions of the draws ``x`` (k, n), by part of a budget.

    The variance by one error is cov(x, pull)^2, which is exact where all is normal and linear. The
    parts are scaled so that they add up to the variance of the draws.
    """
    deviation = x - np.mean(x, axis=1, keepdims=True)
    by_part = {part: np.sum((deviation @ pull) ** 2, axis=1) for part, pull in pulls.items()}
    total = np.sum([*by_part.values()], axis=0)
    scale = np.divide(np.var(x, axis=1), total, out=np.zeros(len(x)), where=total > 0.0)
    return {part: scale * variance for part, variance in by_part.items()}


def posterior(
    car: Vehicle,
    runs: list[RampRun],
    ratio: Value,
    draws: int = _DRAWS,
    priors: Sequence[Prior] = (),
) -> Posterior:
    """Draw from the posterior given the ramps ``runs``.

    ``ratio`` is the prior of ln of the pads' ratio, `DEFAULT_PRIOR` where the user gives none. The
    informative ``priors`` share half of the draws. Raises ValueError where no draw of the prior
    explains the ramps, or a ramp has no usable block.
    """
    from scipy.special import ndtri

    regression, rng = Regression(car, runs), np.random.default_rng(40)

    def log_evidence(x: Array) -> Array:
        e, centre, root = draw_cars(x, priors)
        by_user = log_importance(ratio, e.log_pad_ratio) if ratio != DEFAULT_PRIOR else 0.0
        return regression.solve(e, centre, root).log_evidence + by_user

    x = _tempered(ndtri(spread_evenly(draws, DRAWN + bool(priors))), log_evidence, rng)
    e, centre, root = draw_cars(x, priors)
    _, mean, A, *_ = regression.solve(e, centre, root)
    # draw the linear parameters: with the precision A = C C', C'^-1 noise has the covariance A^-1
    noise = rng.standard_normal(mean.shape)[..., None]
    linear_x = mean + np.linalg.solve(np.linalg.cholesky(A).transpose(0, 2, 1), noise)[..., 0]
    linear = centre + np.einsum("nij,nj->ni", root, linear_x)  # root @ x, of each draw
    front, rear = np.maximum(linear[:, :2].T, 0.1 * CAR.compliance.mean)  # else some are negative
    e = replace(e, compliance_f=front, compliance_r=rear, radius_load=linear[:, 2])
    residual = regression.residuals(e) @ regression.white.T
    from_prior = np.hstack([x[:, :DRAWN], linear_x])  # deviations from the prior (n, k)
    if ratio != DEFAULT_PRIOR:
        deviation = (e.log_pad_ratio - ratio.value) / ratio.sigma
        from_prior[:, PLACES["log_pad_ratio"]] = deviation[:, None]
    errors = regression.errors.items()
    pulls = {part: residual @ (regression.white @ error) for part, error in errors}
    for part, names in _COORDINATES.items():
        columns = [from_prior[:, PLACES[name]] for name in names]
        pulls[part] = np.hstack([pulls.get(part, from_prior[:, :0]), *columns])
    default, *others = np.bincount(prior_index(x, priors), minlength=len(priors) + 1)
    # before the ramps the default prior has as many draws as all informative ones together
    counts = len(priors) * np.array(others, dtype=np.float64)
    return Posterior(
        **vars(e) | regression.discrepancies(residual, rng),
        pulls=pulls,
        misfit=float(np.sqrt(np.mean(residual**2))),
        prior_support=(counts + 0.5) / (counts + default + 1.0),
    )


def _tempered(x: Array, log_evidence: Callable[[Array], Array], rng: np.random.Generator) -> Array:
    """Carry draws ``x`` (n, d) of a standard normal prior to the posterior, by tempering."""
    log, power = log_evidence(x), 0.0
    if not np.any(np.isfinite(log)):
        raise ValueError("no draw of the prior explains the ramps")
    while power < 1.0:
        step = tempering_step(log, 1.0 - power)
        rows = resampled(step * (log - log.max()), rng.random())
        x, log, power = x[rows], log[rows], power + step
        moves = 0.0
        for _ in range(_MOST_MOVES):
            moved = np.sqrt(1.0 - _PCN_STEP**2) * x + _PCN_STEP * rng.standard_normal(x.shape)
            log_moved = log_evidence(moved)
            accepted = np.log(rng.random(log.size)) < power * (log_moved - log)
            x, log = np.where(accepted[:, None], moved, x), np.where(accepted, log_moved, log)
            moves += float(np.mean(accepted))
            if moves > _ACCEPTED_MOVES:
                break
    return x


def resampled(log: Array, offset: float) -> Index:
    """Return rows (n,) of draws with weights of ln ``log`` (n,), by systematic resampling.

    Row i is taken where the cumulative weight passes (i + ``offset``)/n, with an offset of 0 to 1.
    """
    share = np.cumsum(np.exp(log - log.max()))
    return np.asarray(np.searchsorted(share / share[-1], (np.arange(log.size) + offset) / log.size))


def tempering_step(log: Array, largest: float) -> float:
    """Return the next step of the power of the likelihood, ``largest`` at most, by bisection.

    ``log`` is ln of the likelihood of the draws (n,). The step leaves an effective sample size of
    `_ESS_FRACTION`, or more where it is the largest.
    """
    low, high = 0.0, 2.0 * largest  # so that the first trial is ``largest``
    for _ in range(41):
        power = min(0.5 * (low + high), largest)
        weight = np.exp(power * (log - log.max()))
        ess = weight.sum() ** 2 / (weight @ weight) / log.size
        low, high = (power, high) if ess >= _ESS_FRACTION else (low, power)
    return min(high, largest)
