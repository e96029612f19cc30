"""Draws of what a car may be: tyres, pads, loads, radii; and what they make of forces.

Quasi-static loads, rising branch of the tyre: not true while the body pitches or a wheel locks.
"""

from dataclasses import dataclass, fields

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.plain import rows
from calib.car.forces import speed_ratio
from calib.car.tyre_forms import NEAR_PEAK, mean_inverse
from calib.car.vehicle import Vehicle
from calib.model.settings import SETTINGS

ROWS = {row["name"]: row for row in rows("priors.csv", "calib.fitting")}
PRIORS = {
    name: (float(row["mean"]), float(row["sigma"] or SETTINGS.pad_scatter))
    for name, row in ROWS.items()
}
"""Mean and sigma of each prior by name. The file has their sources, the share of the field's
variance by which cars of one ``model`` are apart, and the sigma of what a ``tyre_file`` says."""

DEPART_AT = np.linspace(0.05, 0.95, 10)
"""Decelerations at which the departure of a tyre from its form is kept [1]."""

_LEAST_LOAD = 1e-3  # of an axle over the weight [1]: below it the axle lifts


@dataclass(frozen=True)
class Ensemble:
    """Draws of a car, equally likely. All (n,) [1] where no unit is said; ``forms`` (n, 5).

    ``forms`` weights of `calib.car.tyre_forms`; ``load_exponent`` by which the compliance grows
    with the load, ``peak_load_exponent`` by which the peak falls; ``peak`` at half the weight;
    ``log_pad_ratio`` front over rear, over that of the vehicle file; ``cg_to_front_axle``,
    ``cg_height`` over those of the file; ``compliance_f``, ``compliance_r`` slip per normalised
    force at small slip and half the weight; ``radius_load`` share by which a rolling radius falls
    when the load of its axle doubles; ``v_late`` time by which v comes after
    the wheel speeds [s]; ``depart_eta``, ``depart_slip`` (n, k) what eta - 1 and the
    mean slip depart from all that by, relative, at the decelerations `DEPART_AT` (k,).
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

    def take(self, which: Index | Mask | slice) -> "Ensemble":
        """These draws alone."""
        return Ensemble(*(getattr(self, f.name)[which] for f in fields(Ensemble)))


@dataclass(frozen=True)
class UnitSlips:
    """What draws make of forces, (n, k) [1].

    ``front``, ``rear`` slips per compliance; ``grown_f``, ``grown_r`` relative growth of the loads,
    which moves the radii; ``share`` of the front load; ``rolls`` where both axles are below their
    peaks and on the road.
    """

    front: Array
    rear: Array
    grown_f: Array
    grown_r: Array
    share: Array
    rolls: Mask


def unit_slips(
    car: Vehicle, e: Ensemble, z: Array, front: Array, rear: Array, peak: Array | float = 1.0
) -> UnitSlips:
    """Slips per compliance of every draw at the deceleration ``z`` (k,) [1], (6), (7), (15), (16).

    ``front``, ``rear`` tyre forces of the axles over the weight (n, k); ``peak`` of the road over
    that of the ramp (n,).
    """
    L = car.wheelbase
    l_f = (e.cg_to_front_axle * car.cg_to_front_axle)[:, None]
    moved = (e.cg_height * car.cg_height)[:, None] * z
    loads = ((L - l_f + moved) / L, (l_f - moved) / L)  # (6), (7)
    top = (e.peak * peak)[:, None]
    slips, rolls = [], np.ones(loads[0].shape, dtype=bool)
    for force, load in zip((front, rear), loads, strict=True):
        on_road = np.maximum(load, _LEAST_LOAD)
        relative = np.log(2.0 * on_road)
        most = top * np.exp(-e.peak_load_exponent[:, None] * relative)
        use = force / on_road / most
        rolls &= (use < NEAR_PEAK) & (load > _LEAST_LOAD)
        slips.append(
            most * mean_inverse(use, e.forms) * np.exp(e.load_exponent[:, None] * relative)
        )
    return UnitSlips(
        front=slips[0],
        rear=slips[1],
        grown_f=loads[0] * L / (L - l_f) - 1.0,
        grown_r=loads[1] * L / l_f - 1.0,
        share=loads[0],
        rolls=rolls,
    )


@dataclass(frozen=True)
class Shown:
    """What wheels show of forces, (n, k) [1].

    ``rise`` of eta (22) and the mean ``slip`` by load, both with the departures of the draws;
    ``slip_f``, ``slip_r`` of the tyres; ``rolls`` as of `UnitSlips`.
    """

    rise: Array
    slip: Array
    slip_f: Array
    slip_r: Array
    rolls: Mask


def shown(
    car: Vehicle,
    e: Ensemble,
    z: Array,
    front: Array,
    rear: Array,
    *,
    at: Array | None = None,
    peak: Array | float = 1.0,
    softer: tuple[Array | float, Array | float] = (1.0, 1.0),
) -> Shown:
    """What the draws show at the deceleration ``z`` (k,) or (n, 1) [1].

    ``front``, ``rear``, ``peak`` as of `unit_slips`; ``at`` (k,) where departures are read, if not
    at ``z``; ``softer`` compliances of the axles over those of the ramp, (n, 1).
    """
    unit = unit_slips(car, e, z, front, rear, peak)
    slip_f = softer[0] * e.compliance_f[:, None] * unit.front
    slip_r = softer[1] * e.compliance_r[:, None] * unit.rear
    fall = e.radius_load[:, None]
    shown_f = 1.0 - (1.0 - slip_f) * np.exp(fall * unit.grown_f)
    shown_r = 1.0 - (1.0 - slip_r) * np.exp(fall * unit.grown_r)
    mean = unit.share * shown_f + (1.0 - unit.share) * shown_r
    hats = np.eye(DEPART_AT.size)
    between = np.stack([np.interp(z if at is None else at, DEPART_AT, hat) for hat in hats])
    return Shown(
        rise=(speed_ratio(shown_f, shown_r) - 1.0) * (1.0 + e.depart_eta @ between),
        slip=mean * (1.0 + e.depart_slip @ between),
        slip_f=slip_f,
        slip_r=slip_r,
        rolls=unit.rolls,
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
