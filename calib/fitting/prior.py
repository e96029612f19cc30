r"""The prior of a car before its ramps: the default prior, and informative priors of the user.

A car has coordinates, whose default prior (`beliefs.csv`) is standard normal. An informative prior
is another normal distribution of the coordinates:

    standard normal x --prior--> coordinates --> draw of a car

A tyre file, or the fleet (released cars of the same model), gives an informative prior. Half of the
draws keep the default prior, for a car that contradicts the informative ones.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from calib.base.arrays import Array, Index
from calib.car.beliefs import CAR, Belief
from calib.car.tyre_file import TyreFile
from calib.car.tyre_forms import FORMS, inverse_forms
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import DEPART_AT, Ensemble, ensemble_of, spread_evenly
from calib.table.table import Table, Value

_LOGS = ("peak", "cg_to_front_axle", "cg_height")  # quantities whose ln has the prior
_NONLINEAR = ("load_exponent", "peak_load_exponent", "peak", "log_pad_ratio", "cg_to_front_axle",
              "cg_height")  # fmt: skip
_PAD_RATIO = _NONLINEAR.index("log_pad_ratio")
NAMES = (*["form"] * len(FORMS), *_NONLINEAR, "compliance", "log_tyre_ratio", "radius_load")
"""Names of the coordinates in their order: tyre forms, other nonlinear ones, and linear ones."""
PLACES = {name: np.flatnonzero(np.array(NAMES) == name).tolist() for name in NAMES}
"""Indices of the coordinates of each name."""
DRAWN = len(FORMS) + len(_NONLINEAR)  # number of the nonlinear ones; others are integrated out

_COMPLIANCE, _SIGMA = CAR.compliance.mean, CAR.compliance.sigma
_APART = 0.5 * CAR.log_tyre_ratio.sigma * _COMPLIANCE  # sigma of half the difference of the axles
_LINEAR = np.array([_COMPLIANCE, _COMPLIANCE, CAR.radius_load.mean])
_TO_LINEAR = np.array(
    [[_SIGMA, _APART, 0.0], [_SIGMA, -_APART, 0.0], [0.0, 0.0, CAR.radius_load.sigma]]
)
"""(front compliance, rear compliance, fall of the radii) = _LINEAR + _TO_LINEAR @ coordinates."""

_BELIEFS: list[Belief] = [getattr(CAR, name) for name in NAMES]
_MEAN, _STD = np.array([(x.mean, x.sigma) for x in _BELIEFS[len(FORMS) : DRAWN]]).T
"""Mean and standard deviation of the quantities `_NONLINEAR`, or of their ln."""
_SPARSE = 0.6  # Dirichlet concentration of the forms: two or three make up most of a tyre
_OTHER_SHARE, _WIDER = 0.1, 4.3  # of cars with other pads or a fault: share, factor of the scatter
_VARIANCE_IN_MODEL = np.array([belief.model for belief in _BELIEFS])
"""Variance of each coordinate between the cars of a model, over that between all cars."""
_FILE_SIGMA = np.array([belief.tyre_file / belief.sigma for belief in _BELIEFS])
"""Standard deviation of each coordinate of a car about its tyre file."""
_UNINFORMED = 0.5  # posterior over prior variance, above which ramps are taken to say nothing
_COUNT = 200.0  # effective sample size of the draws of a table


@dataclass(frozen=True)
class Prior:
    """A normal prior of the coordinates."""

    name: str
    code: str  # of the warning where the ramps contradict the prior
    mean: Array  # (k,)
    covariance: Array  # (k, k)


_DEFAULT = Prior("the field", "", np.zeros(len(NAMES)), np.eye(len(NAMES)))


def draw_cars(x: Array, priors: Sequence[Prior]) -> tuple[Ensemble, Array, Array]:
    """Return cars of standard normal ``x`` (n, DRAWN), and the prior of the linear parameters.

    With ``priors``, a further column of ``x`` decides which a draw has. The linear parameters,
    compliances and ``radius_load``, are integrated out: the cars have 1 in their place. Given the
    other coordinates they are normal, with a centre (n, 3) and the upper triangular root U
    (n, 3, 3) of their covariance U U'.
    """
    y, centre = np.empty((len(x), DRAWN)), np.empty((len(x), 3))
    root, index = np.empty((len(x), 3, 3)), prior_index(x, priors)
    for i, prior in enumerate((_DEFAULT, *priors)):
        rows, factor = index == i, np.linalg.cholesky(prior.covariance)
        # nonlinear coordinates, and the mean of the linear ones given these
        coordinates = prior.mean + x[rows, :DRAWN] @ factor[:, :DRAWN].T
        y[rows] = coordinates[:, :DRAWN]
        centre[rows] = _LINEAR + coordinates[:, DRAWN:] @ _TO_LINEAR.T
        linear = _TO_LINEAR @ factor[DRAWN:, DRAWN:]
        # with the lower triangular root C of the precision: U = C'^-1
        root[rows] = np.linalg.inv(np.linalg.cholesky(np.linalg.inv(linear @ linear.T))).T
    return _cars(y), centre, root


def prior_index(x: Array, priors: Sequence[Prior]) -> Index:
    """Return the prior of each draw (n,): 0 for the default prior, i for the i-th of ``priors``."""
    from scipy.special import ndtr

    # the default prior has the numbers below 1/2, the others have equal parts of those above
    begins = np.linspace(0.5, 1.0, len(priors) + 1)[:-1]
    return np.asarray(np.searchsorted(begins, ndtr(x[:, -1])), dtype=np.int64)


def log_importance(user_prior: Value, log_ratio: Array) -> Array:
    """Return ln(p_user/p_default) at ``log_ratio`` (n,), for prior densities p up to a factor."""
    r = log_ratio / CAR.log_pad_ratio.sigma
    default = (1.0 - _OTHER_SHARE) * np.exp(-0.5 * r**2)
    default += _OTHER_SHARE / _WIDER * np.exp(-0.5 * (r / _WIDER) ** 2)
    return np.asarray(
        -0.5 * ((log_ratio - user_prior.value) / user_prior.sigma) ** 2 - np.log(default)
    )


@cache
def _pad_ratio_table() -> tuple[Array, Array]:
    """Return standard normal numbers, and ln(ratio)/sigma of the pads at the same quantiles."""
    from scipy.special import ndtr, ndtri

    r = np.linspace(-9.0, 9.0, 2001)
    below = (1.0 - _OTHER_SHARE) * ndtr(r) + _OTHER_SHARE * ndtr(r / _WIDER)
    return ndtri(np.clip(below, 1e-15, 1.0 - 1e-15)), r


@cache
def _amount_table() -> tuple[Array, Array]:
    """Return standard normal numbers, and ln of gamma variates at the same quantiles."""
    from scipy.special import gammaincinv, ndtr

    x = np.linspace(-7.0, 7.0, 2001)
    return x, np.log(gammaincinv(_SPARSE, ndtr(x)))


def _cars(y: Array) -> Ensemble:
    """Return cars of nonlinear coordinates ``y`` (n, DRAWN), with linear parameters of 1."""
    columns = y[:, len(FORMS) :].copy()
    columns[:, _PAD_RATIO] = np.interp(columns[:, _PAD_RATIO], *_pad_ratio_table())
    values = dict(zip(_NONLINEAR, (_MEAN + _STD * columns).T, strict=True))
    values |= {name: np.exp(values[name]) for name in _LOGS}
    values |= dict.fromkeys(("compliance_f", "compliance_r", "radius_load"), np.ones(len(y)))
    values |= dict.fromkeys(("depart_eta", "depart_slip"), np.zeros((len(y), DEPART_AT.size)))
    return Ensemble(forms=_weights_of(y[:, : len(FORMS)]), v_late=np.zeros(len(y)), **values)


def _coordinates(e: Ensemble) -> Array:
    """Return the coordinates (n, k) of draws, the inverse of `_cars`."""
    rng = np.random.default_rng(44)
    # The weights leave the sum of the amounts of forms open: it is drawn. Dirichlet distributed
    # weights times a gamma variate are independent gamma variates.
    amounts = e.forms * rng.gamma(_SPARSE * len(FORMS), size=(e.size, 1))
    forms = np.interp(np.log(np.maximum(amounts, 1e-30)), *_amount_table()[::-1])
    values = vars(e) | {name: np.log(getattr(e, name)) for name in _LOGS}
    nonlinear = (np.stack([values[name] for name in _NONLINEAR], axis=1) - _MEAN) / _STD
    nonlinear[:, _PAD_RATIO] = np.interp(nonlinear[:, _PAD_RATIO], *_pad_ratio_table()[::-1])
    return np.hstack([forms, nonlinear, np.linalg.solve(_TO_LINEAR, (e.linear - _LINEAR).T).T])


def _weights_of(x: Array) -> Array:
    """Return weights of the forms (n, 5) from their standard normal coordinates ``x`` (n, 5)."""
    amount = np.exp(np.interp(x, *_amount_table()))
    return np.asarray(amount / amount.sum(axis=1, keepdims=True))


def informative_priors(
    car: Vehicle, tyres: Sequence[TyreFile], fleet: Mapping[str, Table]
) -> tuple[Prior, ...]:
    """Return the priors by tyre files and by the fleet, where there are any. Raises TyreError."""
    by_tyres = (_by_tyres(car, tyres),) if tyres else ()
    return (*by_tyres, _by_fleet(car, fleet)) if fleet else by_tyres


def _by_tyres(car: Vehicle, tyres: Sequence[TyreFile]) -> Prior:
    """Return the prior by the tyre file of both axles, or by those of the front and the rear."""
    use = np.linspace(0.1, 0.9, 20)  # force over its peak
    rows, compliances, slips = [], [], []  # of the axles
    mean, sigma = np.zeros(_FILE_SIGMA.size), _FILE_SIGMA.copy()
    for tyre, axle_load in zip((tyres[0], tyres[-1]), car.static_loads, strict=True):
        loads = 0.5 * axle_load * np.array([0.8, 1.0, 1.25])
        log_values = np.log([tyre.at_load(load) for load in loads])  # stiffness, peak (3, 2)
        # both are straight lines over ln of (load / quarter of the weight)
        relative_loads = np.log(4.0 * loads / car.weight)
        slopes, (log_stiffness, log_peak) = np.polyfit(relative_loads, log_values, 1)
        radius_load = tyre.radius_load(loads[1])
        if radius_load is None:  # the file does not say it: the default prior
            radius_load, sigma[PLACES["radius_load"]] = CAR.radius_load.mean, 1.0
        rows.append([*-slopes, log_peak, radius_load])
        compliances.append(np.exp(-log_stiffness))
        slips.append(np.interp(use, *tyre.curve(loads[1])))
    *nonlinear, radius_load = np.mean(rows, axis=0)
    for name, x in zip(("load_exponent", "peak_load_exponent", "peak"), nonlinear, strict=True):
        mean[PLACES[name]] = (x - getattr(CAR, name).mean) / getattr(CAR, name).sigma
    mean[DRAWN:] = np.linalg.solve(_TO_LINEAR, [*compliances, radius_load] - _LINEAR)
    sigma[PLACES["compliance"] + PLACES["log_tyre_ratio"]] *= np.mean(compliances) / _COMPLIANCE
    covariance, form = np.diag(sigma**2), PLACES["form"]
    mean[form], covariance[np.ix_(form, form)] = _forms_like(use, np.mean(slips, axis=0))
    return Prior(" and ".join(t.name for t in tyres), "tyre_file", mean, covariance)


def _forms_like(use: Array, slip: Array) -> tuple[Array, Array]:
    """Return mean (5,) and covariance (5, 5) of the coordinates of forms that fit a curve.

    The curve is ``slip`` over ``use``, the force over its peak, (k,) [1] each.
    """
    from scipy.special import ndtri

    x = np.asarray(ndtri(spread_evenly(4096, len(FORMS))))
    misfit = np.mean((_weights_of(x) @ inverse_forms(use).T / slip - 1.0) ** 2, axis=1)
    weight = np.exp(-0.5 * (misfit - misfit.min()) / (CAR.form.tyre_file / CAR.form.sigma) ** 2)
    return np.average(x, axis=0, weights=weight), np.cov(x.T, aweights=weight, ddof=0)


def _by_fleet(car: Vehicle, fleet: Mapping[str, Table]) -> Prior:
    """Return the prior of a further car of the model, from tables of the ``fleet`` by name@version.

    The cars of a model scatter normally about its mean (a hierarchical model, Gelman et al.,
    Bayesian Data Analysis, ch. 5). The draws of a car, less the default prior, give the likelihood
    of its ramps; the likelihoods of all cars give the mean of the model.
    """
    identity = np.eye(_VARIANCE_IN_MODEL.size)
    # precision P of the mean of the model, and P times the mean; first the prior of that mean
    precision = np.diag(1.0 / (1.0 - _VARIANCE_IN_MODEL))
    scaled_mean = np.zeros(_VARIANCE_IN_MODEL.size)
    for table in fleet.values():
        x = _coordinates(ensemble_of(car, table.draws))
        variance, axes = np.linalg.eigh(np.cov(x.T) + 1e-6 * identity)
        axes, variance = axes[:, variance < _UNINFORMED], variance[variance < _UNINFORMED]
        shrink = (_COUNT - x.shape[1] - 2.0) / (_COUNT - 1.0)  # mean of an inverse Wishart
        posterior_precision = shrink / variance
        # the likelihood of the ramps: the draws less the default prior, whose precision is 1
        information = axes @ np.diag(posterior_precision - 1.0) @ axes.T
        scaled_mean_of_car = axes @ (posterior_precision * (axes.T @ x.mean(axis=0)))
        # the scatter V between the cars reduces what one car says of their mean, by (1 + I V)^-1
        reduction = np.linalg.inv(identity + information * _VARIANCE_IN_MODEL)
        precision = precision + reduction @ information
        scaled_mean = scaled_mean + reduction @ scaled_mean_of_car
    variance_of_mean: Array = np.linalg.inv(0.5 * (precision + precision.T)).astype(np.float64)
    covariance = variance_of_mean + np.diag(_VARIANCE_IN_MODEL)
    return Prior("the fleet", "fleet_prior", variance_of_mean @ scaled_mean, covariance)
