"""What the pads of a calibration rest on, by cause: see `calib.table.budget`."""

import numpy as np

from calib.base.arrays import Array
from calib.car.vehicle import Vehicle
from calib.fitting.one_axle_ramps import with_both_axles
from calib.fitting.pad_level import level_sigmas
from calib.model.parameters import AT
from calib.model.ramp import RampRun
from calib.model.resistance import Resistance
from calib.table.budget import Parts, axle_budgets
from calib.table.table import Calibration, TableBudget


def table_budget(
    vehicle: Vehicle, level: Parts, pads: Calibration, posterior: dict[str, Array]
) -> TableBudget:
    """The budget of a table as it is stored with it.

    ``level`` by `level_parts`, ``posterior`` covariance of `RampParameters` by part.
    """
    at = AT.log_pad_ratio
    ratio = {part: float(share[at, at]) for part, share in posterior.items()}
    front, rear = axle_budgets(vehicle, pads, level, ratio)
    return TableBudget(
        front=front.relative,
        rear=rear.relative,
        level=dict(level),
        posterior={part: tuple(map(tuple, x.tolist())) for part, x in posterior.items()},
    )


def level_parts(
    vehicle: Vehicle, scales: Array, runs: list[RampRun], known: Resistance
) -> dict[str, float]:
    """Variance of the logarithm of the common pad level of the ramps [1] by part.

    Mass, accelerometer and resistance are common to all runs, so more runs do not shrink them; what
    the runs differ by counts as noise. ``scales`` of the ramps with both axles; the others take no
    part.
    """
    normal = with_both_axles(runs)
    of_runs = np.array([level_sigmas(vehicle, run, known) for run in normal]).mean(axis=0)
    noise, resistance, accelerometer = (float(x) for x in of_runs**2)
    return {
        "mass": vehicle.mass_tolerance**2,
        "resistance": resistance,
        "accelerometer": accelerometer,
        "noise": noise + float(np.var(scales)) / len(normal),
    }
