"""Level and ratio of the pads of a calibration: what merging and comparing of cars counts in."""

import math
from typing import NamedTuple

from calib.car.balance import front_share
from calib.car.vehicle import Vehicle
from calib.table.table import Calibration


class PadLevels(NamedTuple):
    """Logarithms [1], against the pads of the vehicle file.

    ``level`` of the brake force of both axles per pressure, which the sum of forces fixes;
    ``ratio`` of the pads, front over rear.
    """

    level: float
    ratio: float


def pad_levels(vehicle: Vehicle, pads: Calibration) -> PadLevels:
    """Level and ratio of the pads of a calibration."""
    front = pads.pad_friction_f.value / vehicle.front.pad_friction
    rear = pads.pad_friction_r.value / vehicle.rear.pad_friction
    share = front_share(vehicle, 0.0)
    return PadLevels(math.log(share * front + (1.0 - share) * rear), math.log(front / rear))


def pad_scale(vehicle: Vehicle, levels: PadLevels) -> float:
    """Common factor on the pads of the vehicle file [1]; with the ratio it gives both axles."""
    share, half = front_share(vehicle, 0.0), math.exp(0.5 * levels.ratio)
    return math.exp(levels.level) / (share * half + (1.0 - share) / half)
