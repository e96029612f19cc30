"""What the pads of a calibration rest on, by cause: see `calib.table.budget`."""

import numpy as np

from calib.car.vehicle import Vehicle
from calib.fitting.identify import Identified
from calib.fitting.one_axle_ramps import with_both_axles
from calib.fitting.pad_level import level_sigmas
from calib.model.parameters import AT
from calib.model.ramp import RampRun
from calib.model.resistance import Resistance
from calib.table.budget import Parts, axle_budgets
from calib.table.table import Calibration, TableBudget


def table_budget(
    vehicle: Vehicle, found: Identified, level: Parts, pads: Calibration
) -> TableBudget:
    """The budget of a table as it is stored with it; ``level`` by `level_parts`."""
    at = AT.log_pad_ratio
    ratio = {part: float(share[at, at]) for part, share in found.parts.items()}
    front, rear = axle_budgets(vehicle, pads, level, ratio)
    return TableBudget(
        front=front.relative,
        rear=rear.relative,
        level=dict(level),
        posterior={
            part: tuple(tuple(float(x) for x in row) for row in share)
            for part, share in found.parts.items()
        },
    )


def level_parts(
    vehicle: Vehicle, found: Identified, runs: list[RampRun], known: Resistance
) -> Parts:
    """Variance of the logarithm of the common pad level of the ramps [1] by part.

    Mass, accelerometer and resistance are common to all runs, so more runs do not shrink them; what
    the runs differ by counts as noise. Ramps with one axle only take no part.
    """
    normal = with_both_axles(runs)
    of_runs = np.array([level_sigmas(vehicle, run, known) for run in normal]).mean(axis=0)
    noise, resistance, accelerometer = (float(x) for x in of_runs**2)
    between = float(np.var(found.pad_scale)) / len(normal)
    return {
        "mass": vehicle.mass_tolerance**2,
        "resistance": resistance,
        "accelerometer": accelerometer,
        "noise": noise + between,
    }
