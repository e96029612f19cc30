"""Draws of a car's unknowns (tyres, pads, loads, radii), and eta and slip that each draw predicts.

    Ensemble --loaded_tyres--> LoadedTyres --slips--> slips over compliance --wheel_slips--> slips

`predict_slips` does these steps at once. Valid for quasi-static loads, not while the body pitches,
and below the peak of the tyre. Shapes: n draws, k decelerations, 2 axles (front, rear).
"""

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.car.balance import front_share, rotating_shares, tyre_forces
from calib.car.forces import axle_loads, speed_ratio
from calib.car.tyre_forms import NEAR_PEAK, mean_inverse
from calib.car.vehicle import Vehicle
from calib.table.maps import Draws
from calib.table.table import Calibration

DEPART_AT = np.linspace(0.05, 0.95, 10)
"""Decelerations of the columns of ``depart_eta`` and ``depart_slip`` [1]."""

TABLE_DRAWS = 400
"""Draws that a table stores: they give a standard deviation to 4 %."""

_LEAST_LOAD = 1e-3  # load of an axle over the weight, below which the axle lifts [1]
_STICKS = 0.3  # slip below which a tyre does not slide [1]


@dataclass(frozen=True)
class Ensemble:
    """Equally likely draws of a car, one in each row; the columns are those of `Draws`.

    `calib.table.maps.Draws` explains them. Other than there, ``cg_to_front_axle`` and ``cg_height``
    are over those of the vehicle file [1]. ``depart_eta`` and ``depart_slip`` (n, 10), relative
    discrepancies of the tyre form, are at `DEPART_AT`.
    """

    forms: Array
    load_exponent: Array
    peak_load_exponent: Array
    peak: Array
    log_pad_ratio: Array
    cg_to_front_axle: Array
    cg_height: Array
    compliance_f: Array
    compliance_r: Array
    radius_load: Array
    v_late: Array
    depart_eta: Array
    depart_slip: Array

    @property
    def size(self) -> int:
        """Number of draws."""
        return int(self.peak.size)

    @property
    def log_stiffness(self) -> Array:
        """ln of the slip stiffness, as geometric mean of the axles, (n,) [1]."""
        return np.asarray(-0.5 * np.log(self.compliance_f * self.compliance_r))

    @property
    def linear(self) -> Array:
        """Front and rear compliance, and fall of the radii with load, (n, 3) [1]."""
        return np.stack([self.compliance_f, self.compliance_r, self.radius_load], axis=1)

    def take(self, rows: Index | Mask | slice) -> "Ensemble":
        """Return the draws of these ``rows``."""
        return Ensemble(*(getattr(self, f.name)[rows] for f in fields(Ensemble)))


_LENGTHS = ("cg_to_front_axle", "cg_height")
"""Columns that `Draws` has in m, and an `Ensemble` over their value in the vehicle file."""


def draws_of(car: Vehicle, e: Ensemble, pads: Calibration) -> Draws:
    """`TABLE_DRAWS` draws for a table; the level of the ``pads`` is drawn independently."""
    stored = e.take(np.linspace(0, e.size - 1, TABLE_DRAWS).astype(np.int64))
    lengths = {name: getattr(stored, name) * getattr(car, name) for name in _LENGTHS}
    columns = vars(stored) | lengths
    scale, normal = pads.pad_scale, np.random.default_rng(42).standard_normal(TABLE_DRAWS)
    level = np.log(scale.value) + scale.sigma / scale.value * normal
    return Draws(**columns, log_pad_level=level, weight=np.full(TABLE_DRAWS, car.weight))


def ensemble_of(car: Vehicle, draws: Draws) -> Ensemble:
    """The ensemble of the draws that a table of ``car`` stores."""
    columns = vars(draws) | {name: getattr(draws, name) / getattr(car, name) for name in _LENGTHS}
    return Ensemble(**{f.name: columns[f.name] for f in fields(Ensemble)})


class _UnitSlips(NamedTuple):
    """Slips and loads of the axles by draw, (2, n, k) [1]."""

    slip: Array  # over the compliance (..., 2, n, k)
    load: Array  # over the weight
    load_rise: Array  # change of the load over the load at rest, which changes the radii
    rolls: Mask  # whether both axles are on the road and below the peaks of tyres (..., n, k)


class LoadedTyres(NamedTuple):
    """Tyres of draws under their axle loads, (2, n, k) [1]."""

    load: Array  # over the weight
    on_road: Array  # the same, but at least `_LEAST_LOAD`
    load_rise: Array  # change of the load over the load at rest
    peak: Array  # of the normalised force
    compliance: Array  # over the compliance at half the weight
    forms: Array  # weights of the tyre forms (n, 5)

    def take(self, draws: Index) -> "LoadedTyres":
        """Return the tyres of these ``draws``."""
        return LoadedTyres(*(np.take(x, draws, axis=-2) for x in self))

    def slips(self, forces: Array) -> _UnitSlips:
        """Slips over compliance by (15), (16); tyre ``forces`` over the weight (..., 2, n, k)."""
        use = forces / self.on_road / self.peak
        unit = mean_inverse(use, self.forms)
        return _UnitSlips(
            slip=self.peak * unit * self.compliance,
            load=self.load,
            load_rise=self.load_rise,
            rolls=np.all((use < NEAR_PEAK) & (self.load > _LEAST_LOAD), axis=-3),
        )


def loaded_tyres(car: Vehicle, e: Ensemble, z: Array, peak: Array | float = 1.0) -> LoadedTyres:
    """Tyres of draws at decelerations ``z`` (n, k) [1]; ``peak`` is over that of the ramp, (n,)."""
    L = car.wheelbase
    l_f = (e.cg_to_front_axle * car.cg_to_front_axle)[:, None]
    moved = (e.cg_height * car.cg_height)[:, None] * z
    load = np.stack([L - l_f + moved, l_f - moved]) / L  # (6), (7)
    on_road = np.maximum(load, _LEAST_LOAD)
    log_load = np.log(2.0 * on_road)  # over half the weight
    return LoadedTyres(
        load=load,
        on_road=on_road,
        load_rise=load * L / np.stack([L - l_f, l_f]) - 1.0,
        peak=(e.peak * peak)[:, None] * np.exp(-e.peak_load_exponent[:, None] * log_load),
        compliance=np.exp(e.load_exponent[:, None] * log_load),
        forms=e.forms,
    )


def wheel_slips(e: Ensemble, unit: _UnitSlips, softer: Array | float = 1.0) -> tuple[Array, Array]:
    """True slips of the tyres, and the apparent slips by the wheel speeds, (2, n, k) [1].

    They differ since a wheel whose radius fell with its load turns faster. ``softer`` is the
    compliance over that on the ramp, (2, n, 1).
    """
    slips = softer * np.stack([e.compliance_f, e.compliance_r])[..., None] * unit.slip
    return slips, 1.0 - (1.0 - slips) * np.exp(e.radius_load[:, None] * unit.load_rise)


class SlipPrediction(NamedTuple):
    """Predicted eta and slips of a braking, by draw, (n, k) [1].

    ``eta_rise`` and ``slip`` are zeroed on the lead-in and include the discrepancy of the form.
    """

    z: Array  # decelerations (k,)
    eta_rise: Array  # eta - 1 by (22)
    slip: Array  # mean of the apparent slips of the axles, weighed by load
    forces: Array  # of the tyres, over the loads of the vehicle file (2, n, k)
    slips: Array  # true slips of the tyres (2, n, k)
    rolls: Mask  # whether both axles are on the road and no tyre is beyond its peak or slides

    @property
    def eta(self) -> Array:
        """Median of eta over the draws, (k,) [1]."""
        return np.asarray(1.0 + np.median(self.eta_rise, axis=0))


def predict_slips(
    car: Vehicle,
    e: Ensemble,
    log_ratio: Array,
    brake: Array,
    z: Array,
    *,
    peak: Array | float = 1.0,
    softer: Array | float = 1.0,
) -> SlipPrediction:
    """Predict eta and slips where the brakes alone slow the car.

    ``brake`` force of both axles over the weight, and ``log_ratio`` of the pads as in
    `front_share`, both of a shape that broadcasts to (n, k); ``z`` (k,) measured deceleration, at
    which the discrepancies are read; all [1]. ``peak`` as in `loaded_tyres`, ``softer`` as in
    `wheel_slips`.
    """
    slowed = brake / (1.0 + sum(rotating_shares(car)))  # deceleration by the brakes alone [1]
    tyres = np.stack(tyre_forces(car, front_share(car, log_ratio), brake, slowed))
    unit = loaded_tyres(car, e, slowed, peak).slips(tyres)
    slips, apparent = wheel_slips(e, unit, softer)
    # weights (10, k) that interpolate linearly from `DEPART_AT` to z
    between = np.stack([np.interp(z, DEPART_AT, hat) for hat in np.eye(DEPART_AT.size)])
    return SlipPrediction(
        z=z,
        eta_rise=(speed_ratio(*apparent) - 1.0) * (1.0 + e.depart_eta @ between),
        slip=np.sum(unit.load * apparent, axis=0) * (1.0 + e.depart_slip @ between),
        forces=tyres / np.stack(axle_loads(car, np.atleast_2d(slowed))) * car.weight,
        slips=slips,
        rolls=unit.rolls & np.all(slips < _STICKS, axis=0),
    )


def spread_evenly(count: int, dimension: int) -> Array:
    """Points (count, dimension) in the open unit cube: a low-discrepancy sequence.

    Additive recurrence with the powers of the root of x^(d+1) = x + 1 (Roberts 2018).
    """
    root = 2.0
    for _ in range(50):
        root = (1.0 + root) ** (1.0 / (dimension + 1))
    steps = root ** -np.arange(1.0, dimension + 1)
    points = (0.5 + np.arange(1, count + 1)[:, None] * steps) % 1.0
    return np.clip(points, 1e-9, 1.0 - 1e-9)
