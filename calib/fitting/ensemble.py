"""Draws of what a car may be: tyres, pads, loads, radii; and what they make of forces.

Quasi-static loads, rising branch of the tyre: not true while the body pitches or a wheel locks.
"""

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.car.balance import braked_tyres, front_share, turning_shares
from calib.car.forces import axle_loads, speed_ratio
from calib.car.tyre import NEAR_PEAK, mean_inverse
from calib.car.vehicle import Vehicle
from calib.table.maps import Draws
from calib.table.table import Calibration

DEPART_AT = np.linspace(0.05, 0.95, 10)
"""Decelerations at which the departure of a tyre from its form is kept [1]."""

KEPT = 400
"""Draws that a table keeps: a standard deviation is then known to 4 %."""

_LEAST_LOAD = 1e-3  # of an axle over the weight [1]: below it the axle lifts
_STICKS = 0.3  # slip below which a tyre is not seen to slide [1]


@dataclass(frozen=True)
class Ensemble:
    """Draws of a car, equally likely, (n,) [1] where nothing else is said.

    ``forms`` weights of `calib.car.tyre` (n, 5); ``load_exponent`` by which the compliance
    grows with the load, ``peak_load_exponent`` by which the ``peak`` at half the weight falls;
    ``log_pad_ratio`` front over rear, ``cg_to_front_axle``, ``cg_height``, all over those of the
    vehicle file; ``compliance_f``, ``compliance_r`` slip per normalised force at small slip and
    half the weight; ``radius_load`` share by which a rolling radius falls when the load of its axle
    doubles; ``v_late`` by which v comes after the wheel speeds [s]; ``depart_eta``, ``depart_slip``
    relative, by which eta - 1 and the mean slip depart from all that at `DEPART_AT`, (n, 10).
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
        """ln of the slip stiffness, the geometric mean of the axles, (n,)."""
        return np.asarray(-0.5 * np.log(self.compliance_f * self.compliance_r))

    @property
    def linear(self) -> Array:
        """Compliances and fall of the radii, (n, 3)."""
        return np.stack([self.compliance_f, self.compliance_r, self.radius_load], axis=1)

    def take(self, which: Index | Mask | slice) -> "Ensemble":
        """These draws alone."""
        return Ensemble(*(getattr(self, f.name)[which] for f in fields(Ensemble)))


_LENGTHS = ("cg_to_front_axle", "cg_height")
"""Columns in m in the draws of a table, and over the vehicle file's here."""


def draws_of(car: Vehicle, e: Ensemble, pads: Calibration) -> Draws:
    """What a table keeps: `KEPT` draws, with the level of the pads that the sum of forces gives."""
    kept, scale = e.take(np.linspace(0, e.size - 1, KEPT).astype(np.int64)), pads.pad_scale
    x = np.random.default_rng(42).standard_normal(KEPT)
    columns = vars(kept) | {name: getattr(kept, name) * getattr(car, name) for name in _LENGTHS}
    level = np.log(scale.value) + scale.sigma / scale.value * x
    return Draws(**columns, log_pad_level=level, weight=np.full(KEPT, car.weight))


def ensemble_of(car: Vehicle, draws: Draws) -> Ensemble:
    """The ensemble of which a table of ``car`` kept these draws."""
    columns = vars(draws) | {name: getattr(draws, name) / getattr(car, name) for name in _LENGTHS}
    return Ensemble(**{one.name: columns[one.name] for one in fields(Ensemble)})


class _UnitSlips(NamedTuple):
    """What draws make of forces: of the axles (2, n, k), all [1].

    ``slip`` per compliance; ``load`` over the weight, ``grown`` by what share of that at rest,
    which moves the radii; ``rolls`` (n, k) where both axles are below their peaks and on the road.
    """

    slip: Array
    load: Array
    grown: Array
    rolls: Mask


def unit_slips(
    car: Vehicle, e: Ensemble, z: Array, forces: Array, peak: Array | float = 1.0
) -> _UnitSlips:
    """Slips per compliance of every draw at decelerations ``z`` (n, k) [1], (6), (7), (15), (16).

    ``forces`` of the tyres of front and rear axle over the weight (2, n, k); ``peak`` of the road
    over that of the ramp (n,).
    """
    L = car.wheelbase
    l_f = (e.cg_to_front_axle * car.cg_to_front_axle)[:, None]
    moved = (e.cg_height * car.cg_height)[:, None] * z
    load = np.stack([L - l_f + moved, l_f - moved]) / L  # (6), (7)
    on_road = np.maximum(load, _LEAST_LOAD)
    relative = np.log(2.0 * on_road)
    most = (e.peak * peak)[:, None] * np.exp(-e.peak_load_exponent[:, None] * relative)
    use = forces / on_road / most
    unit = np.stack([mean_inverse(of, e.forms) for of in use])
    return _UnitSlips(
        slip=most * unit * np.exp(e.load_exponent[:, None] * relative),
        load=load,
        grown=load * L / np.stack([L - l_f, l_f]) - 1.0,
        rolls=np.all((use < NEAR_PEAK) & (load > _LEAST_LOAD), axis=0),
    )


def turned(e: Ensemble, unit: _UnitSlips, softer: Array | float = 1.0) -> tuple[Array, Array]:
    """Slips of the tyres of the axles (2, n, k) [1], and those that their wheel speeds show.

    ``softer`` compliances over the ramp's, (2, n, 1). A wheel whose radius fell turns faster.
    """
    slips = softer * np.stack([e.compliance_f, e.compliance_r])[..., None] * unit.slip
    return slips, 1.0 - (1.0 - slips) * np.exp(e.radius_load[:, None] * unit.grown)


class Shown(NamedTuple):
    """What wheels show of a braking that demands the decelerations ``z`` (k,), (n, k) [1].

    ``shift`` eta - 1 by (22) and the mean ``slip`` by load, over the lead-in, both with the
    departures of the draws; of the tyres of the axles (2, n, k) ``forces`` over the loads that the
    vehicle file gives, and ``slips``; ``rolls`` as of `_UnitSlips`, where no tyre is seen to slide.
    """

    z: Array
    shift: Array
    slip: Array
    forces: Array
    slips: Array
    rolls: Mask

    @property
    def eta(self) -> Array:
        """Median of the draws, (k,)."""
        return np.asarray(1.0 + np.median(self.shift, axis=0))


def shown(
    car: Vehicle,
    e: Ensemble,
    log_ratio: Array,
    brake: Array,
    z: Array,
    *,
    peak: Array | float = 1.0,
    softer: Array | float = 1.0,
) -> Shown:
    """What the draws show where the ``brake`` force of both axles over the weight alone slows the
    car, and it seems to slow by ``z`` (k,) [1], at which departures are read.

    ``brake`` and ``log_ratio``, as of `front_share`, (n, k) or what broadcasts to it; ``peak`` as
    of `unit_slips`; ``softer`` compliances of the axles over the ramp's, (2, n, 1).
    """
    slowed = brake / (1.0 + sum(turning_shares(car)))
    tyres = np.stack(braked_tyres(car, front_share(car, log_ratio), brake, slowed))
    unit = unit_slips(car, e, slowed, tyres, peak)
    slips, turning = turned(e, unit, softer)
    between = np.stack([np.interp(z, DEPART_AT, hat) for hat in np.eye(DEPART_AT.size)])
    return Shown(
        z=z,
        shift=(speed_ratio(*turning) - 1.0) * (1.0 + e.depart_eta @ between),
        slip=np.sum(unit.load * turning, axis=0) * (1.0 + e.depart_slip @ between),
        forces=tyres / np.stack(axle_loads(car, np.atleast_2d(slowed))) * car.weight,
        slips=slips,
        rolls=unit.rolls & np.all(slips < _STICKS, axis=0),
    )


def spread_evenly(count: int, dimension: int) -> Array:
    """Points (count, dimension) in the open unit cube, more evenly than random ones.

    Additive recurrence with the powers of the root of x^(d+1) = x + 1 (Roberts 2018).
    """
    root = 2.0
    for _ in range(50):
        root = (1.0 + root) ** (1.0 / (dimension + 1))
    steps = root ** -np.arange(1.0, dimension + 1)
    points = (0.5 + np.arange(1, count + 1)[:, None] * steps) % 1.0
    return np.clip(points, 1e-9, 1.0 - 1e-9)
