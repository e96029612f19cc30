"""The metrics of a car as a whole, each with its meaning and unit.

The metrics of each hold-out are those of `calib.estimation.metrics`; they are judged stop by stop.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.base.plain import bound, meanings
from calib.car.forces import front_biased_up_to
from calib.car.vehicle import Vehicle
from calib.estimation.validate import Validation, agreement
from calib.line.station.golden import golden_metrics
from calib.line.station.sides import side_difference
from calib.logs.log import Log
from calib.run.driving_record import driving_record
from calib.run.wheels import axles_of, slips_of
from calib.store.listing import band_width
from calib.table.table import MEASURED, Table

METRICS: dict[str, str] = meanings("car")
"""Every metric of the car, with its meaning."""


@dataclass(frozen=True)
class Car:
    """The inputs of a verdict on a car.

    ``ramps`` the logs that the table was fitted on, without coasts; ``stops`` the hold-outs and
    ``results`` their validations; ``golden`` the table of its model, if there is one.
    """

    table: Table
    ramps: Sequence[Log]
    stops: Sequence[Log]
    results: Sequence[Validation]
    golden: Table | None = None


def metrics_of(car: Car) -> dict[str, float | None]:
    """All `METRICS` of a car; None where its logs cannot give one."""
    table, cal = car.table, car.table.calibration
    out: dict[str, float | None] = {
        "ramp_deceleration": table.quality["deceleration_max"],
        "measured_share": float(np.mean(table.paper.flag == MEASURED)),
        "band_width": band_width(table),
        "ramp_eta_zero": _largest([_eta_zero(table.vehicle, log) for log in car.ramps]),
        "pad_scale": cal.pad_scale.value,
        "pad_ratio": float(np.exp(cal.pad_log_ratio.value)),
        "front_biased_up_to": _front_biased_up_to(table),
    }
    for axle in "fr":
        sides = [side_difference(table, log, axle) for log in car.ramps]
        out[f"side_difference_{axle}"] = _largest([s.value if s else None for s in sides])
    together = agreement(list(car.results))
    out["repeatability_f"] = together.spread_f if together else None
    out["repeatability_r"] = together.spread_r if together else None
    golden = golden_metrics(table, car.golden) if car.golden else {}
    return {name: (out | golden).get(name) for name in METRICS}


def _eta_zero(vehicle: Vehicle, log: Log) -> float | None:
    driving = driving_record(log)
    found = axles_of(log, driving, slips_of(log, driving)).front_rear
    return None if found is None else vehicle.radius_mismatch(found.value)


def _front_biased_up_to(table: Table) -> float:
    """z [1] at which both axles use the same friction, with the identified pads.

    At most the value that stands for all larger ones.
    """
    car, cal = table.vehicle, table.calibration
    front = replace(car.front, pad_friction=cal.pad_friction_f.value)
    rear = replace(car.rear, pad_friction=cal.pad_friction_r.value)
    biased = front_biased_up_to(replace(car, front=front, rear=rear))
    return min(biased, bound("front_biased_up_to", "cut"))


def _largest(values: Sequence[float | None]) -> float | None:
    """The value of largest magnitude, with its sign."""
    return max((v for v in values if v is not None), key=abs, default=None)
