"""What the user says of the pads' ratio: by a roller brake tester, or by tolerances in his file."""

import math
from collections.abc import Iterator

from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import PRIORS
from calib.model.roller_bench import RollerBench
from calib.table.table import Calibration, Value

UNSAID = Value(*PRIORS["log_pad_ratio"])
"""ln of the pads' ratio over that of the file where the user said nothing."""


def stated_pad_ratio(vehicle: Vehicle, bench: RollerBench | None) -> Value | None:
    """ln of (mu_f/mu_r) over its value in the vehicle file [1]; None where the user said nothing.

    Rollers measured the very pads: where they are given, the tolerances of the file, which speak of
    the grade, say no more. Raises BenchError and ModelError as `RollerBench.log_pad_ratio`.
    """
    if bench is not None:
        return bench.log_pad_ratio(vehicle)
    front, rear = vehicle.front.pad_friction_tolerance, vehicle.rear.pad_friction_tolerance
    if front is None and rear is None:
        return None
    unsaid = UNSAID.sigma / math.sqrt(2.0)  # of one axle, where he speaks of the other only
    return Value(0.0, math.hypot(*(unsaid if one is None else one for one in (front, rear))))


def measured(vehicle: Vehicle, bench: RollerBench | None, pads: Calibration) -> Iterator[str]:
    """What the rollers said of the pads, beside what the ramps say of their level."""
    if bench is None:
        return
    ratio, level = bench.log_pad_ratio(vehicle), bench.log_pad_level(vehicle)
    yield (
        f"roller brake tester {bench.name}: pads front/rear {math.exp(ratio.value):.3f} times "
        f"nominal, known to {100.0 * ratio.sigma:.2g} %, one sigma; their level is "
        f"{math.exp(level.value) / pads.pad_scale.value:.2f} times that of the ramps, which counts"
    )
