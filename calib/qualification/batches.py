"""Checks of `batch`: several stops in worker processes, and a damaged log among them."""

from calib.fleet.columns import Status
from calib.qualification.check import COUNT, Check
from calib.qualification.fitted import BODY, FRONT
from calib.qualification.material import DAMAGED, Material
from calib.qualification.stops import STOPS

FOLDER = "third_party"


def _rows(material: Material) -> dict[str, tuple[str, float]]:
    return material.batch(FOLDER, tuple(stop for stop, _, _ in STOPS.values()))


def _pads(material: Material) -> float:
    """Largest relative error of the front pads of a stop [1]."""
    rows = _rows(material)
    return max(abs(rows[stop][1] / front - 1.0) for stop, front, _ in STOPS.values())


def _statuses(material: Material) -> float:
    """How many rows have the right status: an error for the damaged log, and no other error."""
    rows = _rows(material)
    return float(sum((name == DAMAGED) == (row[0] == Status.ERROR) for name, row in rows.items()))


CHECKS = (
    Check(
        "batch_pads", "largest relative error of the front pads of three stops in results.parquet",
        "1", 0.0, FRONT, BODY, _pads,
    ),
    Check(
        "batch_rows", "right rows of three stops and a log that is cut in half", "rows",
        len(STOPS) + 1, COUNT, "the log was cut by this check", _statuses,
    ),
)  # fmt: skip
