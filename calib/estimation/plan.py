"""What an estimate starts from: nominal pads, known resistance, noise of the sensors."""

from dataclasses import dataclass, replace

import numpy as np

from calib.car.balance import brake_forces
from calib.car.effects.combined import as_driven
from calib.car.effects.effects import Effects
from calib.car.mass import weighed
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.model.resistance import DRAG, ROLLING, Resistance
from calib.run.axle_signals import Signals
from calib.run.noise import SensorNoise, lead_in_noise, worst_noise
from calib.table.budget import Parts, level_of
from calib.table.table import Table


@dataclass(frozen=True)
class Plan:
    """What stays the same over a log.

    ``nominal`` the car with the pads that the estimate starts from; ``known`` the resistance;
    ``noise`` of the sensors; ``ramp_level`` variance of the logarithm of the level of the nominal
    pads [1] by part, none where the user gives these pads.
    """

    table: Table
    nominal: Vehicle
    known: Resistance
    noise: SensorNoise
    ramp_level: Parts


def plan_for(
    table: Table,
    log: Log,
    s: Signals,
    vehicle: Vehicle | None = None,
) -> Plan:
    """The plan of a log: nominal pads of ``vehicle``, or those of the calibration."""
    return Plan(
        table=table,
        nominal=vehicle or calibrated(table),
        known=known_resistance(table),
        noise=_merged_noise(table, lead_in_noise(log, s)),
        ramp_level=level_of(table) if vehicle is None else {},
    )


def calibrated(table: Table) -> Vehicle:
    """The table's vehicle with the pads of its calibration, in the nominal ratio.

    Scaled so that both axles together brake as they did on the ramp; the ratio is the file's.
    """
    car, cal = table.vehicle, table.calibration
    B_f, B_r = brake_forces(car, np.ones(()), np.ones(()))
    as_fitted = brake_forces(car, np.ones(()), np.ones(()), cal.pad_log_ratio.value)
    scale = cal.pad_scale.value * float(sum(as_fitted) / (B_f + B_r))
    front = replace(car.front, pad_friction=scale * car.front.pad_friction)
    return replace(
        car, front=front, rear=replace(car.rear, pad_friction=scale * car.rear.pad_friction)
    )


def as_used(table: Table, vehicle: Vehicle | None, mass: float | None = None) -> Vehicle:
    """The car of an estimate as it is driven: mass, radii and inertias with their known errors."""
    car = with_effects(table, vehicle, mass)
    return with_pads(as_driven(car, car.effects), vehicle or table.vehicle)


def with_effects(table: Table, vehicle: Vehicle | None, mass: float | None = None) -> Vehicle:
    """The table's car with its known effects and those of ``vehicle``, which go before.

    With a stated ``mass`` [kg] it is as heavy as that, see `calib.car.mass.weighed`.
    """
    own = vehicle.effects if vehicle else Effects()
    return weighed(replace(table.vehicle, effects=table.vehicle.effects.with_(own)), mass)


def with_pads(car: Vehicle, pads: Vehicle) -> Vehicle:
    """``car`` with the nominal pad frictions of the vehicle ``pads``."""
    front = replace(car.front, pad_friction=pads.front.pad_friction)
    return replace(car, front=front, rear=replace(car.rear, pad_friction=pads.rear.pad_friction))


def known_resistance(table: Table) -> Resistance:
    """The resistance the table was fitted with; its parameters' errors taken as independent.

    What the vehicle knows of drag or rolling resistance itself goes before it.
    """
    effects = table.effects.with_(table.vehicle.effects)
    drag, rolling = (table.effects.sigma[effect][name] for effect, name in (DRAG, ROLLING))
    return Resistance(effects, ((drag**2, 0.0), (0.0, rolling**2)), known=True)


def _merged_noise(table: Table, own: SensorNoise) -> SensorNoise:
    """The larger of the table's noise and this log's: a quiet ramp does not make a quiet sensor."""
    return worst_noise([SensorNoise(**table.noise), own])
