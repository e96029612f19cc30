"""The files of a run at the station: all of them, or none.

DIR/station.json  junit.xml  report.html  summary.json  <stop>.parquet  exports

The verdict is moved into place last: without a station.json the run is not complete.
"""

import json
import os
from contextlib import suppress
from pathlib import Path

DOCUMENT, JUNIT, REPORT = "station.json", "junit.xml", "report.html"
FIXED = (DOCUMENT, JUNIT, REPORT, "summary.json")


def publish(work: Path, out: Path) -> list[Path]:
    """Move everything from ``work`` into ``out``, the verdict last; return the paths.

    Files of an earlier run that this one did not make again are removed: an export must not stay
    when the car fails now. Other files in ``out`` stay. If a move fails, the files that were
    already moved are removed. Raises OSError.
    """
    names = sorted((p.name for p in work.iterdir()), key=lambda name: name == DOCUMENT)
    stale = _listed(out) - set(names)
    (out / DOCUMENT).unlink(missing_ok=True)
    for name in stale:
        (out / name).unlink(missing_ok=True)
    try:
        for name in names:
            os.replace(work / name, out / name)
    except BaseException:
        for name in names:
            if not (work / name).exists():
                (out / name).unlink(missing_ok=True)
        raise
    return [out / name for name in names]


def _listed(out: Path) -> set[str]:
    """File names that the verdict in ``out`` lists; none where it cannot be read."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        names = json.loads((out / DOCUMENT).read_text(encoding="utf-8"))["files"]
        return {n for n in names if isinstance(n, str) and n == Path(n).name and n not in FIXED}
    return set()
