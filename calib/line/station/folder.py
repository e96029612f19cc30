"""The files of a run at the station: all of them, or none.

DIR/station.json  junit.xml  report.html  summary.json  <stop>.parquet  exports
DIR/refused.json  instead, where the car could not be judged, see `calib.line.station.refused`

The verdict is moved into place last: without a station.json the run is not complete.
"""

import json
from contextlib import suppress
from pathlib import Path

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.publish import publish
from calib.exports.export import ENDINGS

DOCUMENT, JUNIT, REPORT = "station.json", "junit.xml", "report.html"
REFUSED = "refused.json"
FIXED = (DOCUMENT, JUNIT, REPORT, "summary.json")


def export_name(form: str) -> str:
    """File name of an export of the format ``form``."""
    return f"table.{ENDINGS[form]}"


EXPORTS = frozenset(map(export_name, ENDINGS))
"""Every file that can be an export of a run."""


def publish_run(work: Path, out: Path) -> list[Path]:
    """Move everything from ``work`` into ``out``, the verdict last; return the paths.

    Every export, every file that an earlier verdict lists, and the refusal of an earlier run are
    removed if this run did not make them again: an export must not stay when the car fails now.
    Other files in ``out`` stay. Raises OSError, see `calib.base.publish.publish`.
    """
    return publish(work, out, DOCUMENT, _stale)


def _stale(out: Path) -> set[str]:
    return _listed(out) | EXPORTS | {REFUSED}


def _listed(out: Path) -> set[str]:
    """File names that the verdict in ``out`` lists; none where it cannot be read."""
    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
        names = json.loads(read_bounded(out / DOCUMENT, VALIDATION))["files"]
        return {n for n in names if isinstance(n, str) and n == Path(n).name and n not in FIXED}
    return set()
