"""What the runs of one car say against each other: they were driven within an hour."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from calib.base.warning import PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.estimation.validate import Validation
from calib.logs.log import Log
from calib.run.check import check
from calib.run.limits import LIMITS
from calib.table.budget import front_share
from calib.table.table import Table

LEVEL = 0.06
"""Change of the brakes from the ramp to the stops [1] from which it is named: pads with one load
and one temperature repeat to 2 %, and the estimate of a stop errs by 2 %."""


def log_warnings(vehicle: Vehicle, log: Log) -> Iterator[PlausibilityWarning]:
    """What `brake-cal check` warns of, but for radii of the axles that differ as the file says."""
    for warning in check(log).warnings:
        declared = warning.code == "eta_zero" and (
            abs(vehicle.radius_mismatch(warning.measured)) <= LIMITS.tyres
        )
        if not declared:
            yield warning


def car_warnings(table: Table, results: Sequence[Validation]) -> Iterator[PlausibilityWarning]:
    """A level of the brakes that the ramp and the stops do not share."""
    changes = [change for r in results if (change := level_change(table, r)) is not None]
    if not changes:
        return
    mean = math.exp(float(np.mean(np.log(changes))))
    if abs(math.log(mean)) > LEVEL:
        yield PlausibilityWarning(
            "level_changed",
            table.vehicle.name,
            mean - 1.0,
            (-LEVEL, LEVEL),
            (
                "another load of the car in the ramp than in the stops (state it with --mass)",
                "the scale or the zero of p_mc or a_x, in one of the runs",
                "pads that were wet or hot",
            ),
            "drive ramp and stops with one load and warm, dry pads; check both sensors",
        )


def level_change(table: Table, result: Validation) -> float | None:
    """Brake force of a stop over what the ramp's pads would give [1]; None without an answer."""
    mu_f, mu_r = (result.figures[f"pad_friction_{axle}"] for axle in "fr")
    if mu_f is None or mu_r is None:
        return None
    cal = table.calibration
    share = front_share(table.vehicle, cal.pad_log_ratio.value)
    front, rear = mu_f / cal.pad_friction_f.value, mu_r / cal.pad_friction_r.value
    return share * front + (1.0 - share) * rear
