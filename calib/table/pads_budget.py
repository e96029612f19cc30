"""What the pads of a table's calibration rest on, by cause."""

import numpy as np

from calib.car.balance import brake_forces
from calib.car.vehicle import Vehicle
from calib.table.budget import AxleBudget, Parts, axle_budget
from calib.table.table import Calibration, Table


def pads_budget(table: Table) -> tuple[AxleBudget, AxleBudget]:
    """Budgets of the front and the rear pads of the ramps.

    The sum of the parts is the square of sigma over value of `Calibration.pad_friction_f`, `_r`. A
    table without a budget says how much is open, and nothing of it but the mass.
    """
    cal = table.calibration
    if table.budget is not None:
        return (
            _stored(cal.pad_friction_f.value, table.budget.front),
            _stored(cal.pad_friction_r.value, table.budget.rear),
        )
    ratio = {"ramp": cal.pad_log_ratio.sigma**2}
    return axle_budgets(table.vehicle, cal, level_of(table), ratio)


def axle_budgets(
    vehicle: Vehicle, cal: Calibration, level: Parts, ratio: Parts
) -> tuple[AxleBudget, AxleBudget]:
    """Budgets of front and rear pads from those of level and ratio (variances).

    The ratio of the pads moves each axle by the other one's share of the brake force.
    """
    share = front_share(vehicle, cal.pad_log_ratio.value)
    return (
        axle_budget(cal.pad_friction_f.value, (1.0, level), ((1.0 - share) ** 2, ratio)),
        axle_budget(cal.pad_friction_r.value, (1.0, level), (share**2, ratio)),
    )


def level_of(table: Table) -> Parts:
    """Variance of the logarithm of the pad level of the ramps [1] by part.

    It is that of the sum of forces: the ratio of the pads has no part in it. Of a table without a
    budget only the mass is known.
    """
    if table.budget is not None:
        return table.budget.level
    cal = table.calibration
    of_ratio = (front_share(table.vehicle, cal.pad_log_ratio.value) - 0.5) * cal.pad_log_ratio.sigma
    total = max((cal.pad_scale.sigma / cal.pad_scale.value) ** 2 - of_ratio**2, 0.0)
    mass = min(table.vehicle.mass_tolerance**2, total)
    return {"mass": mass, "ramp": total - mass}


def front_share(vehicle: Vehicle, log_ratio: float) -> float:
    """Share of the front axle in the brake force at one pressure, at a pad ratio."""
    B_f, B_r = brake_forces(vehicle, np.ones(()), np.ones(()), log_ratio)
    return float(B_f / (B_f + B_r))


def _stored(pad_friction: float, sigma: dict[str, float]) -> AxleBudget:
    return AxleBudget(pad_friction, {part: x**2 for part, x in sigma.items()})
