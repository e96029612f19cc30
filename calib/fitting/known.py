r"""What a car may be before its ramps: the field's prior, and half of it what the user knows.

    standard normal x --what is known--> coordinates, standard normal in the field --> a car

What is known, of files of the tyres or of released cars of the model, is a normal distribution.
Half of the draws stay the field's: a car that contradicts what is known takes its answer from it.

    draws of each car --less the field's prior--> what its ramps tell --> model --> one more car

Cars of a model have one mean and scatter about it, all of it normal: a hierarchical model (Gelman
et al., Bayesian Data Analysis, ch. 5).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from calib.base.arrays import Array, Index
from calib.car.beliefs import CAR, Belief
from calib.car.tyre import FORMS, inverse_forms
from calib.car.tyre_file import TyreFile
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import DEPART_AT, Ensemble, ensemble_of, spread_evenly
from calib.table.table import Table, Value

_LOGS = ("peak", "cg_to_front_axle", "cg_height")  # the prior is of their logarithms
_NONLINEAR = ("load_exponent", "peak_load_exponent", "peak", "log_pad_ratio", *_LOGS[1:])
NAMES = (*["form"] * len(FORMS), *_NONLINEAR, "compliance", "log_tyre_ratio", "radius_load")
"""The coordinates in their order: forms, what else enters slips nonlinearly, and linearly."""

OF = {name: [i for i, one in enumerate(NAMES) if one == name] for name in NAMES}
"""Places of the coordinates of a name."""

OWN = len(FORMS) + len(_NONLINEAR)
"""Number of coordinates that are drawn; the others are linear and integrated out."""

COMPLIANCE, _SIGMA, *_ = CAR.compliance
_LESS = 0.5 * CAR.log_tyre_ratio.sigma * COMPLIANCE
_LINEAR = np.array([COMPLIANCE, COMPLIANCE, CAR.radius_load.mean])
_TO_LINEAR = np.array(
    [[_SIGMA, _LESS, 0.0], [_SIGMA, -_LESS, 0.0], [0.0, 0.0, CAR.radius_load.sigma]]
)
"""Compliances and fall of the radii are LINEAR + TO_LINEAR @ (the last three coordinates)."""

_BELIEFS: list[Belief] = [getattr(CAR, name) for name in NAMES]
CENTRE, WIDTH = np.array([one[:2] for one in _BELIEFS[len(FORMS) : OWN]]).T
_SPARSE = 0.6  # concentration of the forms' weights: two or three make up most of a tyre
_OTHER, _APART = 0.1, 4.3  # cars with pads of another grade or a fault; 0.3 in ln of the ratio
_CARS_APART = np.array([one.model for one in _BELIEFS])
_OF_FILE = np.array([one.tyre_file / one.sigma for one in _BELIEFS])
_TOLD = 0.5  # share of the field's variance above which ramps are taken to tell nothing
_COUNT = 200  # independent draws that the kept ones are worth


@dataclass(frozen=True)
class Known:
    """A normal distribution over the coordinates, (k,) and (k, k); ``code`` of the warning."""

    name: str
    code: str
    mean: Array
    covariance: Array


_FIELD = Known("the field", "", np.zeros(len(NAMES)), np.eye(len(NAMES)))


def drawn(x: Array, known: Sequence[Known]) -> tuple[Ensemble, Array, Array]:
    """Draws of standard normal numbers (n, OWN + 1); the linear parameters are not in them.

    Those are normal, too: centre (n, 3) plus root (n, 3, 3) times standard normal ones.
    """
    y, centre, root = (np.empty((len(x), *shape)) for shape in ((OWN,), (3,), (3, 3)))
    for i, one in enumerate((_FIELD, *known)):
        at, own = part_of(x, known) == i, np.linalg.cholesky(one.covariance)
        moved = one.mean + x[at, :OWN] @ own[:, :OWN].T
        y[at], centre[at] = moved[:, :OWN], _LINEAR + moved[:, OWN:] @ _TO_LINEAR.T
        left = _TO_LINEAR @ own[OWN:, OWN:]
        root[at] = np.linalg.inv(np.linalg.cholesky(np.linalg.inv(left @ left.T))).T
    return _cars(y), centre, root


def part_of(x: Array, known: Sequence[Known]) -> Index:
    """What each draw (n,) rests on: 0 the field, then what is known in its order."""
    from scipy.special import ndtr

    shares = np.linspace(0.5, 1.0, len(known) + 1)[:-1]
    return np.asarray(np.searchsorted(shares, ndtr(x[:, -1])), dtype=np.int64)


def log_more(stated: Value, log_ratio: Array) -> Array:
    """ln of the density of pads' ratios by what is ``stated``, over that of the field's prior."""
    r = log_ratio / CAR.log_pad_ratio.sigma
    field = (1.0 - _OTHER) * np.exp(-0.5 * r**2)
    field += _OTHER / _APART * np.exp(-0.5 * (r / _APART) ** 2)
    return np.asarray(-0.5 * ((log_ratio - stated.value) / stated.sigma) ** 2 - np.log(field))


@cache
def _tails() -> tuple[Array, Array]:
    """Standard normal numbers, and those of the pads' ratio with the same quantiles."""
    from scipy.special import ndtr, ndtri

    r = np.linspace(-9.0, 9.0, 2001)
    below = (1.0 - _OTHER) * ndtr(r) + _OTHER * ndtr(r / _APART)
    return ndtri(np.clip(below, 1e-15, 1.0 - 1e-15)), r


@cache
def _amounts() -> tuple[Array, Array]:
    """Standard normal numbers, and ln of the Gamma distributed ones with the same quantiles."""
    from scipy.special import gammaincinv, ndtr

    x = np.linspace(-7.0, 7.0, 2001)
    return x, np.log(gammaincinv(_SPARSE, ndtr(x)))


def _cars(y: Array) -> Ensemble:
    """Cars of coordinates (n, OWN), of unit compliances."""
    columns = y[:, len(FORMS) :].copy()
    ratio = _NONLINEAR.index("log_pad_ratio")
    columns[:, ratio] = np.interp(columns[:, ratio], *_tails())
    values = dict(zip(_NONLINEAR, (CENTRE + WIDTH * columns).T, strict=True))
    values |= {name: np.exp(values[name]) for name in _LOGS}
    values |= dict.fromkeys(("compliance_f", "compliance_r", "radius_load"), np.ones(len(y)))
    values |= dict.fromkeys(("depart_eta", "depart_slip"), np.zeros((len(y), DEPART_AT.size)))
    return Ensemble(forms=_weights_of(y[:, : len(FORMS)]), v_late=np.zeros(len(y)), **values)


def _coordinates(e: Ensemble) -> Array:
    """Coordinates (n, k) of draws, those of the forms among the many that have their weights."""
    rng = np.random.default_rng(44)
    # weights of a Dirichlet distribution times a gamma variate are independent gamma variates
    amounts = e.forms * rng.gamma(_SPARSE * len(FORMS), size=(e.size, 1))
    forms = np.interp(np.log(np.maximum(amounts, 1e-30)), *_amounts()[::-1])
    values = vars(e) | {name: np.log(getattr(e, name)) for name in _LOGS}
    nonlinear = (np.stack([values[name] for name in _NONLINEAR], axis=1) - CENTRE) / WIDTH
    return np.hstack([forms, nonlinear, np.linalg.solve(_TO_LINEAR, (e.linear - _LINEAR).T).T])


def _weights_of(x: Array) -> Array:
    """Weights of the forms (n, 5) by their standard normal coordinates (n, 5)."""
    amount = np.exp(np.interp(x, *_amounts()))
    return np.asarray(amount / amount.sum(axis=1, keepdims=True))


def known_before(
    car: Vehicle, tyres: Sequence[TyreFile], fleet: Mapping[str, Table]
) -> tuple[Known, ...]:
    """What files of tyres and cars of the model say. Raises TyreError."""
    of_cars = (_of_fleet(car, fleet),) if fleet else ()
    return (_of_tyres(car, tyres), *of_cars) if tyres else of_cars


def _of_tyres(car: Vehicle, tyres: Sequence[TyreFile]) -> Known:
    """What files say of the tyres: one of both axles, or those of the front and the rear axle."""
    use, rows, slips = np.linspace(0.1, 0.9, 20), [], []
    mean, sigma = np.zeros(_OF_FILE.size), _OF_FILE.copy()
    for tyre, axle in zip((tyres[0], tyres[-1]), car.static_loads, strict=True):
        loads = 0.5 * axle * np.array([0.8, 1.0, 1.25])
        told = np.log([tyre.at(load) for load in loads])
        falling, (stiffness, peak) = np.polyfit(np.log(4.0 * loads / car.weight), told, 1)
        fall = tyre.radius_load(loads[1])
        if fall is None:
            fall, sigma[OF["radius_load"]] = CAR.radius_load.mean, 1.0
        rows.append([*-falling, peak, np.exp(-stiffness), fall])
        slips.append(np.interp(use, *tyre.curve(loads[1])))
    *nonlinear, compliance, fall = np.mean(rows, axis=0)
    for name, x in zip(("load_exponent", "peak_load_exponent", "peak"), nonlinear, strict=True):
        mean[OF[name]] = (x - getattr(CAR, name).mean) / getattr(CAR, name).sigma
    mean[OWN:] = np.linalg.solve(_TO_LINEAR, [rows[0][3], rows[1][3], fall] - _LINEAR)
    sigma[OF["compliance"] + OF["log_tyre_ratio"]] *= compliance / COMPLIANCE
    covariance, form = np.diag(sigma**2), OF["form"]
    mean[form], covariance[np.ix_(form, form)] = _form(use, np.mean(slips, axis=0))
    return Known(" and ".join(t.name for t in tyres), "tyre_file", mean, covariance)


def _form(use: Array, slip: Array) -> tuple[Array, Array]:
    """Mean (5,) and covariance (5, 5) of the coordinates of forms that are like a curve (k,)."""
    from scipy.special import ndtri

    x = np.asarray(ndtri(spread_evenly(4096, len(FORMS))))
    off = np.mean((_weights_of(x) @ inverse_forms(use).T / slip - 1.0) ** 2, axis=1)
    weight = np.exp(-0.5 * (off - off.min()) / (CAR.form.tyre_file / CAR.form.sigma) ** 2)
    return np.average(x, axis=0, weights=weight), np.cov(x.T, aweights=weight, ddof=0)


def _of_fleet(car: Vehicle, fleet: Mapping[str, Table]) -> Known:
    """One more car of the model of these tables, by name@version."""
    one = np.eye(_CARS_APART.size)
    precision, pull = np.diag(1.0 / (1.0 - _CARS_APART)), np.zeros(_CARS_APART.size)
    for table in fleet.values():
        x = _coordinates(ensemble_of(car, table.draws))
        v, Q = np.linalg.eigh(np.cov(x.T) + 1e-6 * one)
        shrink = (_COUNT - x.shape[1] - 2.0) / (_COUNT - 1.0)  # of an inverse Wishart's mean
        Q, sharp = Q[:, v < _TOLD], shrink / v[v < _TOLD]
        told, h = Q @ np.diag(sharp - 1.0) @ Q.T, Q @ (sharp * (Q.T @ x.mean(axis=0)))
        through = np.linalg.inv(one + told * _CARS_APART)  # of the mean, less its own scatter
        precision, pull = precision + through @ told, pull + through @ h
    of_mean: Array = np.linalg.inv(0.5 * (precision + precision.T)).astype(np.float64)
    return Known("the fleet", "fleet_prior", of_mean @ pull, of_mean + np.diag(_CARS_APART))
