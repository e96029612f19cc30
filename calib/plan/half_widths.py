"""How well the torque is known: half widths of the front axle, of the rear one, of both."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.table.table import Table


class HalfWidths(NamedTuple):
    """Relative half width of the 95 % interval [1] of the torque of front, rear and both axles."""

    front: float = 0.0
    rear: float = 0.0
    total: float = 0.0


def widths_of(table: Table) -> HalfWidths:
    """Half widths of a table: what its pads, and the level of both axles, are known to."""
    pads = table.calibration
    axles = (pads.pad_friction_f, pads.pad_friction_r)
    front, rear = (Z95 * pad.sigma / pad.value for pad in axles)
    return HalfWidths(front, rear, Z95 * math.sqrt(sum(table.budget.level.values())))


def median(widths: Sequence[HalfWidths]) -> HalfWidths:
    """The median of each half width over cars."""
    return HalfWidths(*np.median(np.array(widths), axis=0).tolist())
