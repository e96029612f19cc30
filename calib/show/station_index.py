"""The page of the runs at a station: the last car, the last runs by their verdicts, and trends."""

import textwrap
from collections import Counter
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from urllib.parse import quote

import numpy as np

from calib.base.plain import counted, metric_of
from calib.base.write import write_whole
from calib.line.station import index
from calib.line.station.files import REPORT
from calib.line.station.index import IndexedRun, runs_below
from calib.show.facts import FAILED, PASSED, WARNING, WORDS, Facts, Picture, Table
from calib.show.html import page_of
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import FRONT, NOMINAL, as_text, axis_ends, names_below

_LAST = 30
"""Number of runs in the first table."""
_DRAWN, _TITLE = 200, 50
"""Number of runs in a trend; letters of a title that have room above a panel."""
_EVERY = 10
"""Time after which the page `LIVE` reloads itself [s]."""
_TORQUES = ("torque_per_bar_f", "torque_per_bar_r")


def write_index(folder: Path) -> int:
    """Write the pages `INDEX` and `LIVE` of the runs below ``folder``; return their number.

    Raises OSError if the folder cannot be read or written.
    """
    runs = runs_below(folder)
    for name, again in ((index.INDEX, 0), (index.LIVE, _EVERY)):
        page = page_of(index_facts(runs, folder.absolute().name, again > 0), again)
        write_whole(folder / name, page.encode())
    return len(runs)


def index_facts(runs: Sequence[IndexedRun], name: str, reloads: bool = False) -> Facts:
    """Return the facts of ``runs``, the last one first, of a page that ``reloads`` or not."""
    counts = Counter(run.verdict for run in runs)
    outcomes = (PASSED, WARNING, FAILED, index.NO_VERDICT, index.UNREADABLE)
    note = f"{index.LIVE} reloads itself every {_EVERY} s; this page stays as it is."
    if reloads:
        note = f"This page reloads itself every {_EVERY} s; {index.INDEX} stays as it is."
    headline, verdict, word = "", "", "No run yet"
    if runs:
        last, why = runs[0], _why(runs[0])
        headline, verdict = f"what to do: {why}" if why else "", _verdict(last)
        word = f"{last.car or last.place}: {_heading(last)}"
    ranks = (FAILED, WARNING, PASSED)
    worst_first = sorted(runs[:_LAST], key=lambda run: ranks.index(_verdict(run)))
    return Facts(
        name,
        headline=headline,
        verdict=verdict,
        word=word,
        numbers=[
            ("car" if len(runs) == 1 else "cars", str(len(runs))),
            *((outcome, str(counts[outcome])) for outcome in outcomes if counts[outcome]),
        ],
        tables=[_table(worst_first, "The last cars, failed and refused ones on top.")],
        notes=[note],
        pictures=_trends(runs[:_DRAWN]),
        parts=[Facts("Earlier cars", tables=[_table(runs[_LAST:])])],
    )


def _verdict(run: IndexedRun) -> str:
    """Return the verdict that colours and sorts a run; a run without a verdict failed."""
    return run.verdict if run.verdict in (PASSED, WARNING) else FAILED


def _trends(runs: Sequence[IndexedRun]) -> list[Picture]:
    """Return one picture of the metrics over the ``runs``, with limits; [] for fewer than two."""
    panels = [panel for panel in (_trend(runs, key) for key in index.TRENDS) if panel]
    caption = f"Brakes and zero of the ramp, of the last {_DRAWN} cars at most; grey: the limits."
    return [Picture(caption, lambda: Sheet("trend", "trend", tuple(panels)))] if panels else []


def _trend(runs: Sequence[IndexedRun], key: str) -> Panel | None:
    """Return the panel of one metric, the last run on the right; None for fewer than two values."""
    values_of_runs = [(run, (run.trend or {}).get(key)) for run in reversed(runs)]
    measured = [(run, value) for run, value in values_of_runs if value is not None]
    if len(measured) < 2:
        return None
    metric, x = metric_of(key), np.arange(float(len(measured)))
    values = np.array([value for _, value in measured])
    limits = next((run.limits[key] for run in runs if run.limits and key in run.limits), ())
    y, ends = metric.factor * values, [metric.factor * end for end in limits if end is not None]
    least_range = [] if ends else [np.median(y) * np.array([0.85, 1.15])]
    title = f"{metric.name}: {metric.value(float(values[-1]))} {metric.unit}"
    return Panel(
        key,
        textwrap.fill(as_text(title), _TITLE),
        "car, the last on the right",
        as_text(f"[{metric.unit or '1'}]"),
        [
            Line(x, y, {**FRONT, "marker": "."}),
            *(Line(x[[0, -1]], [end] * 2, NOMINAL) for end in ends),
        ],
        xlim=(-0.5, x.size - 0.5),
        xticks=names_below([run.car or run.place for run, _ in measured]),
        ylim=axis_ends(y, np.array(ends), *least_range),
    )


def _table(runs: Sequence[IndexedRun], caption: str = "") -> Table:
    """Return a table with a row for each run, and a link to the report of the run."""
    heads = ("car", "verdict", "what to do", "torque per bar f / r [N m]", "station", "time")
    rows, links = [], []
    for run in runs:
        torque = ""
        if run.trend:
            torque = " / ".join(metric_of(key).value(run.trend.get(key)) for key in _TORQUES)
        date = datetime.fromtimestamp(run.written_at).astimezone().strftime("%Y-%m-%d %H:%M")
        rows.append((run.car or run.place, _heading(run), _why(run), torque, run.station, date))
        links.append(quote(f"{run.place}/{REPORT}") if run.verdict != index.NO_VERDICT else "")
    return Table(heads, rows, caption, list(map(_verdict, runs)), links)


def _heading(run: IndexedRun) -> str:
    return WORDS.get(run.verdict, run.verdict.capitalize())


def _why(run: IndexedRun) -> str:
    """Return what to do about a run: the first limit that it breaks, and how many others."""
    if run.verdict == index.UNREADABLE:
        return "what the run wrote is damaged: run the car again"
    if run.verdict == index.NO_VERDICT:
        return run.refusal
    if run.worst is None:
        return f"see the report: {counted(run.bad, 'warning')}" if run.bad else ""
    figure, scope, value, action = run.worst
    metric = metric_of(figure)
    prefix = "" if scope == "car" else f"stop {scope}, "
    more = f" And {run.bad - 1} more." if run.bad > 1 else ""
    return f"{prefix}{metric.name}: {metric.with_unit(value)}. {action}{more}"
