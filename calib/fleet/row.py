"""One log's row."""

import math
from dataclasses import dataclass

from calib.fleet.columns import Status

Cell = float | bool | str | None


@dataclass(frozen=True)
class Row:
    """What a command says of one log.

    ``cells`` follow `calib.fleet.columns` and are empty for an error. ``lost`` marks an error that
    is not the log's: the worker died on it, and the next run tries again.
    """

    log: str
    digest: str | None
    status: Status
    error: str | None
    cells: tuple[Cell, ...] = ()
    lost: bool = False


def number(value: float | None) -> float | None:
    """A plain float; None where there is no finite one."""
    return None if value is None or not math.isfinite(value) else float(value)
