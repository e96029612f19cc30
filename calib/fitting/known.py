r"""What a user knows of a car before its ramps: files of its tyres, released cars of its model.

Each says a normal distribution over coordinates in which the field's prior is standard normal. Half
of the prior stays the field's, so that a car that contradicts what is known takes its answer from
the field.

    draws of each car --less the field's prior--> what its ramps tell --> model --> one more car

Cars of a model have one mean and scatter about it, all of it normal: a hierarchical model (Gelman
et al., Bayesian Data Analysis, ch. 5).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from calib.base.arrays import Array
from calib.base.warning import Measured
from calib.car.tyre_file import TyreFile
from calib.car.tyre_forms import FORMS, inverse_forms
from calib.car.vehicle import Vehicle
from calib.fitting.draws import ensemble_of
from calib.fitting.ensemble import PRIORS, ROWS, spread_evenly
from calib.fitting.pads import UNSAID
from calib.table.generation import require_maps
from calib.table.table import Table, Value

NONLINEAR = (
    "load_exponent",
    "peak_load_exponent",
    "log_peak",
    "log_pad_ratio",
    "cg_to_front_axle",
    "cg_height",
)
"""What enters forces and slips nonlinearly."""

_NAMES = (*["form"] * len(FORMS), *NONLINEAR, "compliance", "log_tyre_ratio", "radius_load")
"""The coordinates in their order, by the rows of the priors."""

OWN = len(FORMS) + len(NONLINEAR)
"""Number of coordinates that are drawn; the others are linear and integrated out."""

_COMPLIANCE, _SIGMA = PRIORS["compliance"]
_LESS = 0.5 * PRIORS["log_tyre_ratio"][1] * _COMPLIANCE
LINEAR = np.array([_COMPLIANCE, _COMPLIANCE, PRIORS["radius_load"][0]])
TO_LINEAR = np.array(
    [[_SIGMA, _LESS, 0.0], [_SIGMA, -_LESS, 0.0], [0.0, 0.0, PRIORS["radius_load"][1]]]
)
"""Compliances and fall of the radii are LINEAR + TO_LINEAR @ (the last three coordinates)."""

_CENTRE, _WIDTH = np.array([PRIORS[name] for name in NONLINEAR]).T
_RATIO = _NAMES.index("log_pad_ratio")
_APART = np.array([float(ROWS[name]["model"]) for name in _NAMES])
_OF_FILE = np.array([float(ROWS[n]["tyre_file"] or PRIORS[n][1]) / PRIORS[n][1] for n in _NAMES])
_SPARSE = 0.6  # concentration of the forms' weights: two or three make up most of a tyre
_TOLD = 0.5  # share of the field's variance above which ramps are taken to tell nothing
_COUNT = 200  # independent draws that the kept ones are worth


@dataclass(frozen=True)
class Known:
    """A normal distribution over the coordinates, (k,) and (k, k); ``code`` of the warning."""

    name: str
    code: str
    mean: Array
    covariance: Array

    def with_ratio(self, ratio: Value) -> tuple[Array, Array, float]:
        """Mean and covariance in the coordinates of ``ratio`` instead of `UNSAID`, and log weight.

        ``ratio`` is what is known of the pads' ratio before the ramps from elsewhere: its density
        over that of `UNSAID` multiplies this one, and says how likely this one is beside the field.
        """
        finer, off = UNSAID.sigma / ratio.sigma, ratio.value / ratio.sigma
        d, h = finer**2 - 1.0, off * finer
        column, at = self.covariance[:, _RATIO], self.mean[_RATIO]
        more = 1.0 + d * column[_RATIO]
        misfit = (d * at**2 - 2.0 * h * at - h**2 * column[_RATIO]) / more + off**2
        scale = np.where(np.arange(column.size) == _RATIO, finer, 1.0)
        mean = scale * (self.mean + column * (h - d * at) / more)
        mean[_RATIO] -= off
        covariance = self.covariance - d * np.outer(column, column) / more
        weight = -0.5 * float(np.log(more / finer**2) + misfit)
        return mean, np.outer(scale, scale) * covariance, weight


def known_before(
    car: Vehicle, tyres: Sequence[TyreFile], fleet: Mapping[str, Table]
) -> tuple[Known, ...]:
    """What files of tyres and cars of the model say. Raises TyreError; StoreError without draws."""
    of_cars = (_of_fleet(car, fleet),) if fleet else ()
    return (_of_tyres(car, tyres), *of_cars) if tyres else of_cars


def contradicted(known: Sequence[Known], held: Array) -> Iterator[Measured]:
    """How likely each is to hold by the ramps, ``held`` (k,), to be judged."""
    return (Measured(one.code, p) for one, p in zip(known, held.tolist(), strict=True))


def likely(known: Sequence[Known], held: Array) -> Iterator[str]:
    """The same in words."""
    for one, p in zip(known, held.tolist(), strict=True):
        yield f"what {one.name} says holds for this car with {100.0 * p:.0f} %, by its ramps"


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
            fall, sigma[-1] = LINEAR[2], 1.0
        rows.append([*-falling, peak, np.exp(-stiffness), fall])
        slips.append(np.interp(use, *tyre.curve(loads[1])))
    *nonlinear, compliance, fall = np.mean(rows, axis=0)
    forms = len(FORMS)
    mean[forms : forms + 3] = (nonlinear - _CENTRE[:3]) / _WIDTH[:3]
    mean[OWN:] = np.linalg.solve(TO_LINEAR, [rows[0][3], rows[1][3], fall] - LINEAR)
    sigma[OWN : OWN + 2] *= compliance / _COMPLIANCE
    covariance = np.diag(sigma**2)
    mean[:forms], covariance[:forms, :forms] = _form(use, np.mean(slips, axis=0))
    return Known(" and ".join(t.name for t in tyres), "tyre_file", mean, covariance)


def _form(use: Array, slip: Array) -> tuple[Array, Array]:
    """Mean (5,) and covariance (5, 5) of the coordinates of forms that are like a curve (k,)."""
    from scipy.special import ndtri

    x = np.asarray(ndtri(spread_evenly(4096, len(FORMS))))
    off = np.mean((weights_of(x) @ inverse_forms(use).T / slip - 1.0) ** 2, axis=1)
    weight = np.exp(-0.5 * (off - off.min()) / _OF_FILE[0] ** 2)
    return np.average(x, axis=0, weights=weight), np.cov(x.T, aweights=weight, ddof=0)


def _of_fleet(car: Vehicle, fleet: Mapping[str, Table]) -> Known:
    """One more car of the model of these tables, by name@version."""
    one = np.eye(_APART.size)
    precision, pull = np.diag(1.0 / (1.0 - _APART)), np.zeros(_APART.size)
    for id_, table in fleet.items():
        require_maps(table, id_)
        x = _coordinates(car, table)
        v, Q = np.linalg.eigh(np.cov(x.T) + 1e-6 * one)
        shrink = (_COUNT - x.shape[1] - 2.0) / (_COUNT - 1.0)  # of an inverse Wishart's mean
        Q, sharp = Q[:, v < _TOLD], shrink / v[v < _TOLD]
        told, h = Q @ np.diag(sharp - 1.0) @ Q.T, Q @ (sharp * (Q.T @ x.mean(axis=0)))
        through = np.linalg.inv(one + told * _APART)  # it tells of the mean, less its own scatter
        precision, pull = precision + through @ told, pull + through @ h
    of_mean: Array = np.linalg.inv(0.5 * (precision + precision.T)).astype(np.float64)
    return Known("the fleet", "fleet_prior", of_mean @ pull, of_mean + np.diag(_APART))


def _coordinates(car: Vehicle, table: Table) -> Array:
    """The draws of a table in coordinates (n, k)."""
    assert table.draws is not None
    e, rng = ensemble_of(car, table.draws), np.random.default_rng(44)
    # weights of a Dirichlet distribution times a gamma variate are independent gamma variates
    amounts = e.forms * rng.gamma(_SPARSE * len(FORMS), size=(e.size, 1))
    logs = {"log_peak": np.log(e.peak), "cg_to_front_axle": np.log(e.cg_to_front_axle),
            "cg_height": np.log(e.cg_height)}  # fmt: skip
    nonlinear = np.stack([{**vars(e), **logs}[name] for name in NONLINEAR], axis=1)
    linear = np.stack([e.compliance_f, e.compliance_r, e.radius_load], axis=1) - LINEAR
    forms = np.interp(np.log(np.maximum(amounts, 1e-30)), *_amounts()[::-1])
    of_linear = np.linalg.solve(TO_LINEAR, linear.T).T
    return np.hstack([forms, (nonlinear - _CENTRE) / _WIDTH, of_linear])


@cache
def _amounts() -> tuple[Array, Array]:
    """Standard normal numbers, and ln of the Gamma distributed ones with the same quantiles."""
    from scipy.special import gammaincinv, ndtr

    x = np.linspace(-7.0, 7.0, 2001)
    return x, np.log(gammaincinv(_SPARSE, ndtr(x)))


def weights_of(x: Array) -> Array:
    """Weights of the forms (n, 5) by their standard normal coordinates (n, 5)."""
    amount = np.exp(np.interp(x, *_amounts()))
    return np.asarray(amount / amount.sum(axis=1, keepdims=True))
