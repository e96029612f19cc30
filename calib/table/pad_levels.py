"""The pads of a table as two numbers: what both axles brake together, and how it is split."""

import math
from typing import NamedTuple

import numpy as np

from calib.car.balance import brake_forces
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
    ratio = math.log(front / rear)
    return PadLevels(math.log(math.sqrt(front * rear)) + _gain(vehicle, ratio), ratio)


def pad_scale(vehicle: Vehicle, levels: PadLevels) -> float:
    """Common factor on the pads of the vehicle file [1]; with the ratio it gives both axles."""
    return math.exp(levels.level - _gain(vehicle, levels.ratio))


def _gain(vehicle: Vehicle, ratio: float) -> float:
    """ln of the brake force per pressure at a pad ratio over that at the ratio of the file."""
    one = np.ones(())
    with_ratio, nominal = (sum(brake_forces(vehicle, one, one, r)) for r in (ratio, 0.0))
    return math.log(float(with_ratio) / float(nominal))
