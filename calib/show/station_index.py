"""The page of an index of runs: the last car, the last runs by their verdicts, and trends."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from urllib.parse import quote

from calib.base.plain import plain
from calib.base.write import write_whole
from calib.line.station.folder import REPORT
from calib.line.station.index import (
    INDEX,
    LIVE,
    NO_VERDICT,
    TRENDS,
    UNREADABLE,
    IndexedRun,
    runs_below,
)
from calib.line.station.words import HEADINGS
from calib.show.html import page

LAST = 30
"""Runs that are shown in full, failed ones on top; the others are in a list below."""

DRAWN = 200
"""Runs in a trend, the last of them."""

EVERY = 10
"""Seconds after which `LIVE` loads itself again."""

KINDS = {
    "passed": "passed",
    "warning": "warning",
    "failed": "failed",
    NO_VERDICT: "failed",
    UNREADABLE: "failed",
}
"""Verdicts, and as which they are drawn and sorted."""


@dataclass(frozen=True)
class Line:
    """A trend as a drawing of 100 by 40: ``points`` x,y of the runs in order, oldest first.

    ``limits``: heights of the limits; ``low``, ``high``: values at the lower and the upper edge,
    ``last``: the last value, all as they are shown; ``label`` says it in words.
    """

    name: str
    key: str
    points: str
    limits: tuple[float, ...]
    low: str
    high: str
    last: str
    label: str


def write_index(folder: Path) -> int:
    """Write `INDEX` and `LIVE` of the runs below ``folder``; return the number of runs.

    Raises OSError if the folder cannot be read or written.
    """
    runs, changed = runs_below(folder)
    for name, every in ((INDEX, 0), (LIVE, EVERY)):
        path = folder / name
        if changed or not path.is_file():
            write_whole(path, index_html(runs, folder.absolute().name, every).encode())
    return len(runs)


def index_html(runs: Sequence[IndexedRun], name: str, every: int = 0) -> str:
    """The page of ``runs``, the last first; it loads itself again after ``every`` [s], 0: never."""
    last = runs[0] if runs else None
    counts = {word: sum(run.verdict == word for run in runs) for word in KINDS}
    return page(
        "index",
        title=f"{name}: {_heading(last)}" if last else name,
        name=name,
        every=every,
        other=LIVE if not every else INDEX,
        last=last and (_car(last), _heading(last), KINDS.get(last.verdict, "failed"), _why(last)),
        counts=[("cars", len(runs)), *((_word(w), n) for w, n in counts.items() if n)],
        trends=[line for key in TRENDS if (line := trend(runs, key)) is not None],
        drawn=DRAWN,
        rows=[_row(run) for run in worst_first(runs[:LAST])],
        shown=LAST,
        more=[_row(run) for run in runs[LAST:]],
    )


def worst_first(runs: Sequence[IndexedRun]) -> list[IndexedRun]:
    """The runs by verdict, failed and refused ones first; equal ones keep their order."""
    ranks = ("failed", "warning", "passed")
    return sorted(runs, key=lambda run: ranks.index(KINDS.get(run.verdict, "failed")))


def trend(runs: Sequence[IndexedRun], key: str) -> Line | None:
    """The trend of a metric over the last runs; None with fewer than two values."""
    values = [
        run.trend[key]
        for run in reversed(runs[:DRAWN])
        if run.trend and run.trend.get(key) is not None
    ]
    known = [v for v in values if v is not None]
    if len(known) < 2:
        return None
    shown = plain(key)
    given = next((run.limits[key] for run in runs if run.limits and key in run.limits), ())
    limits = [x for x in given if x is not None]
    low, high = min(*known, *limits), max(*known, *limits)
    room = 0.08 * (high - low) or 0.01 * abs(high) or 1.0
    low, high = low - room, high + room

    def height(value: float) -> float:
        return round(40.0 * (high - value) / (high - low), 2)

    step = 100.0 / (len(known) - 1)
    ends = shown.value(low), shown.value(high)
    return Line(
        shown.heading,
        key,
        " ".join(f"{i * step:.2f},{height(v)}" for i, v in enumerate(known)),
        tuple(map(height, limits)),
        *ends,
        shown.with_unit(known[-1]),
        f"{shown.name} of the last {len(known)} cars, between {ends[0]} and {ends[1]}; last "
        f"{shown.with_unit(known[-1])}",
    )


def _row(run: IndexedRun) -> dict[str, str]:
    pads = [
        plain(f"pad_friction_{x}").value((run.trend or {}).get(f"pad_friction_{x}")) for x in "fr"
    ]
    return {
        "at": datetime.fromtimestamp(run.at).astimezone().strftime("%Y-%m-%d %H:%M:%S"),
        "car": _car(run),
        "page": quote(f"{run.place}/{REPORT}") if run.verdict != NO_VERDICT else "",
        "verdict": _heading(run),
        "kind": KINDS.get(run.verdict, "failed"),
        "why": _why(run),
        "pads": " / ".join(pads) if run.trend else "",
        "station": run.station,
    }


def _car(run: IndexedRun) -> str:
    return run.car or run.place


def _heading(run: IndexedRun) -> str:
    return HEADINGS.get(run.verdict, run.verdict.capitalize())


def _word(verdict: str) -> str:
    return {"warning": "with warnings"}.get(verdict, verdict)


def _why(run: IndexedRun) -> str:
    """The first metric that is not held and the next step; how many more there are."""
    if run.verdict == UNREADABLE:
        return "what the run wrote is damaged: run the car again"
    if run.verdict == NO_VERDICT:
        return run.refusal
    if run.why is None:
        return f"{run.bad} warning{'s' * (run.bad > 1)}: see the report" if run.bad else ""
    figure, scope, value, action = run.why
    shown = plain(figure)
    of = "" if scope == "car" else f"stop {scope}, "
    more = f" And {run.bad - 1} more." if run.bad > 1 else ""
    return f"{of}{shown.name}: {shown.with_unit(value)}. {action}{more}"
