"""Quality state of a table, from the summary of a validation.

The states are those of CDF 2.0. The last one, `completed`, is never set here: a person sets it.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.errors import ExchangeError
from calib.base.printable import printable

if TYPE_CHECKING:
    from calib.store.summary_file import SummaryFile
    from calib.store.version import Stored

CALIBRATED, CHECKED, PRELIMINARY = "calibrated", "checked", "prelimCalibrated"


@dataclass(frozen=True)
class Quality:
    """``state`` of CDF 2.0 and the same in ``words``; ``verdict`` None without a validation."""

    state: str
    words: str
    verdict: str | None = None


UNPROVED = Quality(CALIBRATED, "none given with this export")
"""Quality of a table without a validation."""


def read_quality(path: Path, stored: "Stored") -> Quality:
    """Quality of a version from the summary.json of `validate --out`.

    Raises ExchangeError when it is no such file or is of another table.
    """
    summary = _summary(path)
    held = [log for log in summary.logs if log.role == "hold-out"]
    if summary.table != stored.id or summary.digest not in (None, stored.digest):
        raise ExchangeError(
            f"is the validation of {_called(summary)}",
            where=path,
            expected=f"one of {stored.id}, digest {stored.digest[:12]}",
            do="validate this version",
        )
    if not held:
        return Quality(CALIBRATED, "only on logs that the table was fitted on: proves nothing")
    verdict, outcomes = summary.verdict, [f"{log.log} {log.verdict}" for log in held]
    words = f"{verdict} on {len(held)} hold-out log{'s' * (len(held) > 1)}: {', '.join(outcomes)}"
    return Quality(CHECKED if verdict == "passed" else PRELIMINARY, printable(words), verdict)


def _called(summary: "SummaryFile") -> str:
    known = f", digest {summary.digest[:12]}" if summary.digest else ""
    return f"{summary.table}{known}"


def _summary(path: Path) -> "SummaryFile":
    from calib.base.record import validated
    from calib.store.summary_file import SummaryFile

    try:
        data = read_bounded(path, VALIDATION)
    except OSError as error:
        raise ExchangeError(f"cannot be read ({error.strerror})", where=path) from error
    try:
        return validated(data, SummaryFile, None, ExchangeError)
    except ExchangeError as error:
        raise ExchangeError(
            f"no summary of a validation: {error}",
            where=path,
            do="take the summary.json of `brake-cal validate --out`",
        ) from error
