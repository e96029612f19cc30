"""The page of an index of runs: the last car, the last runs by their verdicts, and trends."""

import textwrap
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from urllib.parse import quote

import numpy as np

from calib.base.plain import counted, plain
from calib.base.write import write_whole
from calib.line.station.files import REPORT
from calib.line.station.index import (
    INDEX,
    LIVE,
    NO_VERDICT,
    TRENDS,
    UNREADABLE,
    IndexedRun,
    runs_below,
)
from calib.show.facts import FAILED, PASSED, WARNING, WORDS, Facts, Picture, Table
from calib.show.html import page_of
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import FRONT, NOMINAL, Array, as_text

_LAST = 30
"""Runs that are shown in full, failed ones on top; the others are in a table below."""
_DRAWN, _NUMBERED = 200, 12
"""Runs in a trend, the last of them; so many have room for their numbers below the axis."""
_TITLE = 50
"""Letters of a title that have room above a panel."""
_EVERY = 10
"""Seconds after which `LIVE` loads itself again."""
_KINDS = {word: word for word in (PASSED, WARNING, FAILED)} | dict.fromkeys(
    (NO_VERDICT, UNREADABLE), FAILED
)
"""Verdicts, and as which they are drawn and sorted."""


def write_index(folder: Path) -> int:
    """Write `INDEX` and `LIVE` of the runs below ``folder``; return the number of runs.

    Raises OSError if the folder cannot be read or written.
    """
    runs = runs_below(folder)
    for name, every in ((INDEX, 0), (LIVE, _EVERY)):
        page = page_of(facts(runs, folder.absolute().name, every), every)
        write_whole(folder / name, page.encode())
    return len(runs)


def facts(runs: Sequence[IndexedRun], name: str, every: int = 0) -> Facts:
    """The ``runs``, the last first; ``every`` [s]: of the page that loads itself again."""
    last = runs[0] if runs else None
    counts = {word: sum(run.verdict == word for run in runs) for word in _KINDS}
    this, other = ("loads itself again", INDEX) if every else ("stays as it is", LIVE)
    return Facts(
        name,
        headline=f"what to do: {why}" if last and (why := _why(last)) else "",
        verdict=_KINDS.get(last.verdict, FAILED) if last else "",
        word=f"{last.car or last.place}: {_heading(last)}" if last else "No run yet",
        numbers=[
            ("car" if len(runs) == 1 else "cars", str(len(runs))),
            *((w, str(n)) for w, n in counts.items() if n),
        ],
        tables=[_runs(worst_first(runs[:_LAST]), "The last cars, failed and refused ones on top.")],
        notes=[f"This page {this}; {other} is the other one."],
        pictures=_trends(runs),
        parts=[Facts("Earlier cars", tables=[_runs(runs[_LAST:])], folded=True)],
    )


def worst_first(runs: Sequence[IndexedRun]) -> list[IndexedRun]:
    """The runs by verdict, failed and refused ones first; equal ones keep their order."""
    ranks = (FAILED, WARNING, PASSED)
    return sorted(runs, key=lambda run: ranks.index(_KINDS.get(run.verdict, FAILED)))


def _trends(runs: Sequence[IndexedRun]) -> list[Picture]:
    """The trends of all metrics with two values or more."""
    panels = tuple(
        _trend(runs, key, known) for key in TRENDS if len(known := _known(runs, key)) > 1
    )
    told = f"Pads of the ramp, and the zero, of the last {_DRAWN} cars at most; grey: the limits."
    return [Picture(told, lambda: Sheet("trend", "trend", panels))] if panels else []


def _known(runs: Sequence[IndexedRun], key: str) -> Array:
    """The values of a metric, the last run's at the end."""
    values = [(run.trend or {}).get(key) for run in reversed(runs[:_DRAWN])]
    return np.array([value for value in values if value is not None])


def _trend(runs: Sequence[IndexedRun], key: str, known: Array) -> Panel:
    """A metric over the last runs, with its limits."""
    shown, x = plain(key), np.arange(1.0, known.size + 1.0)
    given = next((run.limits[key] for run in runs if run.limits and key in run.limits), ())
    ends = [shown.factor * end for end in given if end is not None]
    title = f"{shown.name}: {shown.value(float(known[-1]))} {shown.unit}"
    return Panel(
        key,
        textwrap.fill(as_text(title), _TITLE),
        "car, the last on the right",
        as_text(f"[{shown.unit or '1'}]"),
        [
            Line(x, shown.factor * known, {**FRONT, "marker": "."}),
            *(Line(x[[0, -1]], [end] * 2, NOMINAL) for end in ends),
        ],
        xticks=["", *map(str, range(1, x.size + 1))] if x.size <= _NUMBERED else (),
    )


def _runs(runs: Sequence[IndexedRun], caption: str = "") -> Table:
    heads = ("car", "verdict", "what to do", "ramp pads f / r", "station", "time")
    reports = [quote(f"{run.place}/{REPORT}") if run.verdict != NO_VERDICT else "" for run in runs]
    kinds = [_KINDS.get(run.verdict, FAILED) for run in runs]
    return Table(heads, [_row(run) for run in runs], caption, kinds, links=reports)


def _row(run: IndexedRun) -> tuple[str, ...]:
    names, trend = ("pad_friction_f", "pad_friction_r"), run.trend or {}
    pads = " / ".join(plain(name).value(trend.get(name)) for name in names) if run.trend else ""
    at = datetime.fromtimestamp(run.at).astimezone().strftime("%Y-%m-%d %H:%M")
    return run.car or run.place, _heading(run), _why(run), pads, run.station, at


def _heading(run: IndexedRun) -> str:
    return WORDS.get(run.verdict, run.verdict.capitalize())


def _why(run: IndexedRun) -> str:
    """The first metric that is not held and the next step; how many more there are."""
    if run.verdict == UNREADABLE:
        return "what the run wrote is damaged: run the car again"
    if run.verdict == NO_VERDICT:
        return run.refusal
    if run.why is None:
        return f"see the report: {counted(run.bad, 'warning')}" if run.bad else ""
    figure, scope, value, action = run.why
    shown = plain(figure)
    of = "" if scope == "car" else f"stop {scope}, "
    more = f" And {run.bad - 1} more." if run.bad > 1 else ""
    return f"{of}{shown.name}: {shown.with_unit(value)}. {action}{more}"
