"""What a run at the station leaves behind: all of it, or nothing.

DIR/station.json  junit.xml  report.html  summary.json  <stop>.parquet  exports

The verdict is moved into place last: where there is no station.json, there is no verdict.
"""

import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

DOCUMENT, JUNIT, REPORT = "station.json", "junit.xml", "report.html"
FIXED = (DOCUMENT, JUNIT, REPORT, "summary.json")


@contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """A hidden folder in ``out`` to make its files in; gone afterwards, whatever happens.

    It lies inside, since ``out`` may be another file system than the folder that it is in. ``out``
    goes too if it was made for this and nothing was put there. Raises OSError at once if nothing
    can be written there.
    """
    made = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory(prefix=".station-", dir=out) as work:
            yield Path(work)
    finally:
        if made:
            with suppress(OSError):
                out.rmdir()


def publish(work: Path, out: Path) -> list[Path]:
    """Move everything from ``work`` into ``out``, the verdict last; return the paths.

    Files of an earlier run that this one did not make again are taken away: an export of a car
    that has failed since must not lie there. What else lies in ``out`` stays. Where a move fails
    those before it are taken away again. Raises OSError.
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
    """Plain file names that the verdict in ``out`` lists; none where it cannot be read."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        names = json.loads((out / DOCUMENT).read_text(encoding="utf-8"))["files"]
        return {n for n in names if isinstance(n, str) and n == Path(n).name and n not in FIXED}
    return set()
