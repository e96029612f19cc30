"""Nominal pads of a table's car, its resistance, and slips by its known effects."""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import StoreError
from calib.car.balance import ForceBalance, front_share, rotating_shares, tyre_forces
from calib.car.effects.effect import Pair
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle
from calib.run.resistance import DRAG, RESISTANCE, ROLLING, Resistance
from calib.table.budget import level_and_ratio
from calib.table.table import Table


@lru_cache(maxsize=4)
def as_driven(table: Table, car: Vehicle) -> Table:
    """Return the table with the ``car`` as driven, cached so that all logs of a batch share it."""
    return replace(table, vehicle=car)


def nominal_car(table: Table, vehicle: Vehicle | None = None) -> Vehicle:
    """Return the table's car with pads of ``vehicle``, by default its own at the ramp's level."""
    car = table.vehicle
    if vehicle:
        return car.with_pads(vehicle.front.pad_friction, vehicle.rear.pad_friction)
    scale = math.exp(level_and_ratio(car, table.calibration).level)
    return car.with_pads(scale * car.front.pad_friction, scale * car.rear.pad_friction)


def known_effects(table: Table) -> Effects:
    """Return the resistance of the fit with the vehicle's known effects, which take precedence."""
    return table.effects.with_(table.vehicle.effects)


def require_plain(table: Table) -> None:
    """Raise StoreError for known effects that the C code does not subtract from its signals."""
    others = [name for name in known_effects(table).described if name not in RESISTANCE]
    if others:
        raise StoreError(
            f"the C code does not take out {', '.join(others)}",
            expected=" and ".join(RESISTANCE) + " alone",
            do="hand out the table in another format, and take the effect out before it is read",
        )


def known_resistance(table: Table) -> Resistance:
    """Return the resistance of the fit, with independent errors of drag and rolling resistance."""
    drag, rolling = (table.effects.sigma[effect][name] for effect, name in (DRAG, ROLLING))
    covariance = ((drag**2, 0.0), (0.0, rolling**2))
    return Resistance(known_effects(table), covariance, specified=True)


def known_slips(table: Table, road: ForceBalance) -> Pair:
    """Return the slip of both axles [1] (n,) that known effects add to the slip by the brakes.

    ``road`` has the forces of the car. Slips follow from the tyre curve of the table, with pads of
    the ramp's ratio; on another road they are wrong by the ratio of the tyres' stiffness there.
    """
    car = table.vehicle
    # without known effects all of the demanded force slows the body and the turning wheels
    body_force = road.demanded / (1.0 + sum(rotating_shares(car)))  # -M dv/dt [N]
    share = front_share(car, table.calibration.pad_log_ratio.value)

    def slip(force: Array, load: Array) -> Array:
        F = force / np.maximum(load, 0.1 * car.weight)
        return np.asarray(np.sign(F) * np.interp(np.abs(F), table.tyre.force, table.tyre.slip))

    front, rear = tyre_forces(car, share, road.demanded, body_force)
    load_f, load_r = axle_loads(car, body_force / car.weight)
    # with known effects, less without; front and rear already contain the inertia of the wheels
    return (
        slip(front + road.drag_no_inertia_f, road.load_f) - slip(front, load_f),
        slip(rear + road.drag_no_inertia_r, road.load_r) - slip(rear, load_r),
    )
