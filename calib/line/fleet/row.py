"""Row of one log in the results."""

import math
from dataclasses import dataclass

from calib.line.fleet.columns import Status

Cell = float | bool | str | None


@dataclass(frozen=True)
class Row:
    """Result of a command for one log.

    ``cells`` follow `calib.line.fleet.columns` and are empty for an error. ``lost`` marks an error
    that the log may not cause: the worker died or had no memory. The next run tries it again.
    """

    log: str
    digest: str | None
    status: Status
    error: str | None
    cells: tuple[Cell, ...] = ()
    lost: bool = False


def number(value: float | None) -> float | None:
    """A float, or None if ``value`` is None or not finite."""
    return None if value is None or not math.isfinite(value) else float(value)
