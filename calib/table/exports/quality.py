"""How far a table was proved, from the summary of a validation.

The states are those of CDF 2.0. `completed`, the last of them, is for a person to give.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.errors import ExchangeError
from calib.table.exports.labels import printable

CALIBRATED, CHECKED, PRELIMINARY = "calibrated", "checked", "prelimCalibrated"


@dataclass(frozen=True)
class Quality:
    """``state`` of CDF 2.0 and the same in ``words``; ``verdict`` None without a validation."""

    state: str
    words: str
    verdict: str | None = None


UNPROVED = Quality(CALIBRATED, "none given with this export")
"""A table of which no validation was given."""


def read_quality(path: Path, table: str) -> Quality:
    """Quality of ``table`` (name@version) from the summary.json of `validate --out`.

    Raises ExchangeError when it is no such file or speaks of another table.
    """
    summary = _summary(path)
    try:
        held = [log for log in summary["logs"] if log["role"] == "hold-out"]
        of, verdict = summary["table"], summary["verdict"]
        outcomes = [f"{log['log']} {log['verdict']}" for log in held]
    except (KeyError, TypeError) as error:
        raise _no_summary(path, f"{error} is missing") from error
    if of != table:
        raise ExchangeError(
            f"is the validation of {of}",
            where=path,
            expected=f"one of {table}",
            do="validate this version",
        )
    if verdict not in ("passed", "failed"):
        raise _no_summary(path, f"verdict {verdict!r}")
    if not held:
        return Quality(CALIBRATED, "only on logs that the table was fitted on: proves nothing")
    words = f"{verdict} on {len(held)} hold-out log{'s' * (len(held) > 1)}: {', '.join(outcomes)}"
    return Quality(CHECKED if verdict == "passed" else PRELIMINARY, printable(words), verdict)


def _summary(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ExchangeError(f"cannot be read ({error.strerror})", where=path) from error
    except ValueError as error:
        raise _no_summary(path, f"not JSON ({error})") from error
    if not isinstance(document, dict):
        raise _no_summary(path, f"a {type(document).__name__}")
    return document


def _no_summary(path: Path, what: str) -> ExchangeError:
    return ExchangeError(
        f"no summary of a validation: {what}",
        where=path,
        expected="the summary.json of `brake-cal validate --out`",
    )
