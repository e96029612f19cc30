"""What is in each column of a log: range, rate, gaps."""

from dataclasses import dataclass

import numpy as np

from calib.logs.clock import GAP, step_of
from calib.logs.log import Array
from calib.logs.whole import TIME, WholeColumn, WholeLog


@dataclass(frozen=True)
class Inventory:
    """One column.

    ``low``, ``high`` in ``unit``, None without a value; ``samples`` rows with a value; ``rate``
    [Hz] of the recording, or by the mean step of those rows; ``gaps`` of more than `GAP` steps:
    time of the last value before each and its length [s].
    """

    name: str
    unit: str | None
    low: float | None
    high: float | None
    samples: int
    rate: float | None
    gaps: tuple[tuple[float, float], ...]


def inventory(log: WholeLog) -> tuple[Inventory, ...]:
    """The columns of a log but its clock. Raises LogError without a valid clock."""
    time = log.time
    return tuple(_of(column, time) for column in log.columns if column.name != TIME)


def _of(column: WholeColumn, time: Array) -> Inventory:
    known = np.isfinite(column.values)
    at, values = time[known], column.values[known]
    steps = np.diff(at)
    usual = step_of(at) if steps.size else 0.0
    rate = column.rate or (1.0 / usual if steps.size else None)
    long = np.flatnonzero(steps > GAP * usual)
    return Inventory(
        column.name,
        column.unit,
        float(values.min()) if values.size else None,
        float(values.max()) if values.size else None,
        int(values.size),
        rate,
        tuple((float(at[i]), float(steps[i])) for i in long),
    )
