"""One log's row."""

import json
import math
from dataclasses import dataclass

from calib.fleet.results_file import STATUSES

Cell = float | bool | str | None


@dataclass(frozen=True)
class Row:
    """What a command says of one log.

    ``cells`` follow `calib.fleet.columns` and are empty for an error. ``lost`` marks an error that
    is not the log's: the worker died on it, and the next run tries again.
    """

    log: str
    digest: str | None
    status: str
    error: str | None
    cells: tuple[Cell, ...] = ()
    lost: bool = False


def to_line(row: Row) -> bytes:
    """One line of JSON; floats come back to the last bit."""
    parts = [row.log, row.digest, row.status, row.error, list(row.cells), row.lost]
    return json.dumps(parts, allow_nan=False).encode() + b"\n"


def from_line(line: bytes) -> Row:
    """The row of a line. Raises ValueError for one that is not whole."""
    log, digest, status, error, cells, lost = json.loads(line)
    if not isinstance(log, str) or status not in STATUSES or not line.endswith(b"\n"):
        raise ValueError("not a row")
    return Row(log, digest, status, error, tuple(cells), bool(lost))


def number(value: float | None) -> float | None:
    """A plain float; None where there is no finite one."""
    return None if value is None or not math.isfinite(value) else float(value)
