"""Draws of a car's unknowns (tyres, pads, loads, radii), and eta and slip that each draw predicts.

    Ensemble --loaded_tyres--> LoadedTyres --unit_slips--> unit slips --wheel_slips--> slips

Unit slips are those of tyres whose compliance is 1 at an axle load of half the weight.
`predict_slips` does these steps at once. They hold for quasi-static loads (not while the body
pitches) and below the peak of the tyre. Shapes: n draws, k decelerations, 2 axles (front, rear).
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

DEPART_AT = np.linspace(0.05, 0.95, 10)  # z of the columns of ``depart_eta``, ``depart_slip`` [1]
TABLE_DRAWS = 400  # draws that a table stores: they give a standard deviation to 4 %
_LEAST_LOAD = 1e-3  # load of an axle over the weight, below which the axle lifts [1]
_SLIDING = 0.3  # slip from which on a tyre slides [1]


@dataclass(frozen=True)
class Ensemble:
    """Equally likely draws of a car, one in each row. Shapes (n,), unit [1], or as said."""

    forms: Array  # weights of `calib.car.tyre_forms` (n, 5)
    load_exponent: Array  # with which the compliance grows with the load
    peak_load_exponent: Array  # with which the peak falls with the load
    peak: Array  # largest normalised force at half the weight
    log_pad_ratio: Array  # ln of the pads' ratio, front over rear, over that of the vehicle file
    cg_to_front_axle: Array  # over that of the vehicle file
    cg_height: Array  # over that of the vehicle file
    compliance_f: Array  # slip per normalised force at small slip and half the weight
    compliance_r: Array
    radius_load: Array  # relative fall of a rolling radius per 100 % of load
    v_late: Array  # delay of v after the wheel speeds [s]
    depart_eta: Array  # relative discrepancy of eta - 1 at `DEPART_AT` (n, 10)
    depart_slip: Array  # relative discrepancy of the mean slip at `DEPART_AT` (n, 10)

    @property
    def size(self) -> int:
        """Number of draws."""
        return int(self.peak.size)

    @property
    def linear(self) -> Array:
        """Front and rear compliance, and fall of the radii with load, (n, 3) [1]."""
        return np.stack([self.compliance_f, self.compliance_r, self.radius_load], axis=1)

    def take(self, rows: Index | Mask | slice) -> "Ensemble":
        """Return the draws of these ``rows``."""
        return Ensemble(*(getattr(self, f.name)[rows] for f in fields(Ensemble)))


_LENGTHS = ("cg_to_front_axle", "cg_height")  # `Draws` has them in m, an `Ensemble` over the file's


def draws_of(car: Vehicle, e: Ensemble, pads: Calibration) -> Draws:
    """Return `TABLE_DRAWS` draws for a table. The level of the ``pads`` is drawn independently."""
    stored = e.take(np.linspace(0, e.size - 1, TABLE_DRAWS).astype(np.int64))
    columns = vars(stored) | {x: getattr(stored, x) * getattr(car, x) for x in _LENGTHS}
    scale, normal = pads.pad_scale, np.random.default_rng(42).standard_normal(TABLE_DRAWS)
    level = np.log(scale.value) + scale.sigma / scale.value * normal
    return Draws(**columns, log_pad_level=level, weight=np.full(TABLE_DRAWS, car.weight))


def ensemble_of(car: Vehicle, draws: Draws) -> Ensemble:
    """Return the ensemble of the draws that a table of ``car`` stores."""
    columns = vars(draws) | {name: getattr(draws, name) / getattr(car, name) for name in _LENGTHS}
    return Ensemble(**{f.name: columns[f.name] for f in fields(Ensemble)})


class LoadedTyres(NamedTuple):
    """Tyres of draws under their axle loads, (2, n, k) [1]."""

    load: Array  # over the weight of the car
    positive_load: Array  # the load, but at least `_LEAST_LOAD`
    load_rise: Array  # change of the load over the load at rest, which changes the radii
    peak: Array  # largest normalised force
    compliance: Array  # over the compliance at half the weight
    forms: Array  # weights of the tyre forms (n, 5)

    def take(self, draws: Index) -> "LoadedTyres":
        """Return the tyres of these ``draws``."""
        return LoadedTyres(*(np.take(x, draws, axis=-2) for x in self))

    def unit_slips(self, forces: Array) -> tuple[Array, Mask]:
        """Return unit slips by (15), (16), (..., 2, n, k) [1], and whether both axles roll.

        ``forces`` of the tyres over the weight (..., 2, n, k). An axle rolls where it is on the
        road and below the peak of its tyres, (..., n, k).
        """
        use = forces / self.positive_load / self.peak
        unit = mean_inverse(use, self.forms)
        rolls = np.all((use < NEAR_PEAK) & (self.load > _LEAST_LOAD), axis=-3)
        return self.peak * unit * self.compliance, rolls


def loaded_tyres(car: Vehicle, e: Ensemble, z: Array, peak: Array | float = 1.0) -> LoadedTyres:
    """Return the tyres of draws at decelerations ``z``, (k,) or (n, k) [1].

    ``peak`` of the road over that of the ramp, (n,) [1].
    """
    L = car.wheelbase
    l_f = (e.cg_to_front_axle * car.cg_to_front_axle)[:, None]
    moved = (e.cg_height * car.cg_height)[:, None] * z
    load = np.stack([L - l_f + moved, l_f - moved]) / L  # (6), (7)
    positive_load = np.maximum(load, _LEAST_LOAD)
    log_load = np.log(2.0 * positive_load)  # over half the weight
    return LoadedTyres(
        load=load,
        positive_load=positive_load,
        load_rise=load * L / np.stack([L - l_f, l_f]) - 1.0,
        peak=(e.peak * peak)[:, None] * np.exp(-e.peak_load_exponent[:, None] * log_load),
        compliance=np.exp(e.load_exponent[:, None] * log_load),
        forms=e.forms,
    )


def wheel_slips(
    e: Ensemble, tyres: LoadedTyres, unit_slips: Array, softer: Array | float = 1.0
) -> tuple[Array, Array]:
    """Return true slips of the tyres, and apparent slips by the wheel speeds, (2, n, k) [1].

    They differ since a wheel whose radius fell with its load turns faster. ``unit_slips`` are those
    of ``tyres``; ``softer`` is the compliance over that on the ramp, (2, n, 1).
    """
    slips = softer * np.stack([e.compliance_f, e.compliance_r])[..., None] * unit_slips
    return slips, 1.0 - (1.0 - slips) * np.exp(e.radius_load[:, None] * tyres.load_rise)


class SlipPrediction(NamedTuple):
    """Predicted eta and slips of a braking, by draw, (n, k) [1]."""

    z: Array  # decelerations (k,)
    eta_rise: Array  # eta - 1 by (22), with the discrepancy of the tyre form; 0 on the lead-in
    slip: Array  # mean of the apparent slips by load, with the discrepancy; 0 on the lead-in
    forces: Array  # of the tyres, over the loads of the vehicle file (2, n, k)
    slips: Array  # true slips of the tyres (2, n, k)
    rolls: Mask  # whether both axles roll, see `LoadedTyres.unit_slips`, and no tyre slides

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

    ``brake`` is the force of both axles over the weight, ``log_ratio`` is ln of front over rear
    brake force, less that of the file's pads at one pressure; both broadcast to (n, k). The
    discrepancies are read at the measured decelerations ``z`` (k,). All are [1]. ``peak`` as in
    `loaded_tyres`, ``softer`` as in `wheel_slips`.
    """
    z_brakes = brake / (1.0 + sum(rotating_shares(car)))  # deceleration by the brakes alone [1]
    forces = np.stack(tyre_forces(car, front_share(car, log_ratio), brake, z_brakes))
    tyres = loaded_tyres(car, e, z_brakes, peak)
    unit_slips, rolls = tyres.unit_slips(forces)
    slips, apparent = wheel_slips(e, tyres, unit_slips, softer)
    # weights (10, k) that interpolate linearly from `DEPART_AT` to z
    between = np.stack([np.interp(z, DEPART_AT, hat) for hat in np.eye(DEPART_AT.size)])
    return SlipPrediction(
        z=z,
        eta_rise=(speed_ratio(*apparent) - 1.0) * (1.0 + e.depart_eta @ between),
        slip=np.sum(tyres.load * apparent, axis=0) * (1.0 + e.depart_slip @ between),
        forces=forces / np.stack(axle_loads(car, np.atleast_2d(z_brakes))) * car.weight,
        slips=slips,
        rolls=rolls & np.all(slips < _SLIDING, axis=0),
    )


def spread_evenly(count: int, dimension: int) -> Array:
    """Return points (count, dimension) in the open unit cube: a low-discrepancy sequence.

    Point i is i (1/r, 1/r^2, ..., 1/r^d) modulo 1, with the root r of r^(d+1) = r + 1 (Roberts
    2018, "The unreasonable effectiveness of quasirandom sequences").
    """
    root = 2.0
    for _ in range(50):  # the fixed-point iteration converges to the last bit
        root = (1.0 + root) ** (1.0 / (dimension + 1))
    steps = root ** -np.arange(1.0, dimension + 1)
    points = (0.5 + np.arange(1, count + 1)[:, None] * steps) % 1.0
    return np.clip(points, 1e-9, 1.0 - 1e-9)
