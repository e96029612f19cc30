"""What a fleet's results say: spread and outliers, drift of the line, and errors by kind."""

import re
from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.fleet.control_chart import Chart, LevelChange, change, chart, least_p
from calib.fleet.outliers import Spread, named, spread
from calib.fleet.results_file import STATUSES, FleetFile, ResultMetric
from calib.toml import did_you_mean

Array = NDArray[np.float64]

DRIFT = 0.01
"""Expected share of figures said to drift that do not."""

EXAMPLES = 3
"""Logs that are named with a kind of error."""


SHORTEST = 3
"""Characters of a log's name without its ending from which it is looked for in a message."""


@dataclass(frozen=True)
class Outlier:
    """A log that stands apart in one figure: its value, robust z and two-sided p."""

    log: str
    figure: str
    value: float
    z: float
    p: float


@dataclass(frozen=True)
class Look:
    """One figure of numbers over the fleet.

    ``rows`` (k,) where it is known, in order; ``values`` (k,) there; ``chart`` None where there are
    too few or nothing scatters; ``change`` None where too few could show one among so many figures;
    ``drifts`` whether it counts among all figures.
    """

    figure: ResultMetric
    rows: NDArray[np.int64]
    values: Array
    spread: Spread
    chart: Chart | None
    change: LevelChange | None
    drifts: bool
    outlying: NDArray[np.bool_]


@dataclass(frozen=True)
class Failure:
    """Errors that say the same of different logs: the message with names and numbers left out."""

    message: str
    count: int
    logs: tuple[str, ...]


@dataclass(frozen=True)
class Shares:
    """A figure of text or yes/no: how often each value came, the most frequent first."""

    figure: ResultMetric
    counts: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Summary:
    """The whole fleet; ``status`` counts of each, ``outliers`` the farthest first."""

    logs: tuple[str, ...]
    ordered_by: str
    status: dict[str, int]
    looks: tuple[Look, ...]
    shares: tuple[Shares, ...]
    outliers: tuple[Outlier, ...]
    failures: tuple[Failure, ...]


def summarise(fleet: FleetFile, wanted: tuple[str, ...] = ()) -> Summary:
    """Summarise all figures, or only those ``wanted``. Raises InputError for an unknown one."""
    figures = _chosen(fleet, wanted)
    numbers = [f for f in figures if f.kind == "number"]
    values = {f.name: fleet.numbers(f.name) for f in numbers}
    spreads = {name: spread(x) for name, x in values.items()}
    p = np.array([s.p for s in spreads.values()]).reshape(len(numbers), len(fleet.logs))
    hits = dict(zip(values, named(p), strict=True))
    known = {name: np.flatnonzero(np.isfinite(x)) for name, x in values.items()}
    # what the logs are ordered by goes up along the line by itself
    along = {name: x[known[name]] for name, x in values.items() if name != fleet.ordered_by}
    changes = _changes(along)
    told = named(np.array([c.p if c else np.nan for c in changes.values()]), DRIFT)
    drifts = dict(zip(changes, told, strict=True))
    looks = tuple(
        Look(
            f,
            known[f.name],
            values[f.name][known[f.name]],
            spreads[f.name],
            chart(along[f.name]) if f.name in along else None,
            changes.get(f.name),
            bool(drifts.get(f.name, False)),
            hits[f.name][known[f.name]],
        )
        for f in numbers
    )
    status = Counter(fleet.texts("status"))
    return Summary(
        fleet.logs,
        fleet.ordered_by,
        {name: status[name] for name in STATUSES if status[name]},
        looks,
        tuple(_shares(fleet, f) for f in figures if f.kind != "number" and _is_class(fleet, f)),
        _outliers(fleet, looks),
        failures(fleet.logs, fleet.texts("error")),
    )


def _changes(lines: dict[str, Array]) -> dict[str, LevelChange | None]:
    """Change of each line; None where the plainest one would not count beside steady figures."""
    found = {name: change(x) for name, x in lines.items()}
    enough = DRIFT / max(sum(c is not None for c in found.values()), 1)
    return {n: c if c and least_p(lines[n].size) <= enough else None for n, c in found.items()}


def _chosen(fleet: FleetFile, wanted: tuple[str, ...]) -> tuple[ResultMetric, ...]:
    known = {figure.name: figure for figure in fleet.figures}
    for name in wanted:
        if name not in known:
            raise InputError(
                f"no figure {name!r}",
                where=fleet.path,
                expected=f"one of {', '.join(known)}",
                do=did_you_mean(name, known),
            )
    return tuple(known[name] for name in wanted) or fleet.figures


MANY = 20
"""More different texts than this are names, digests: no classes."""


def _is_class(fleet: FleetFile, figure: ResultMetric) -> bool:
    return figure.kind == "yes/no" or len({*fleet.texts(figure.name)}) <= MANY


def _shares(fleet: FleetFile, figure: ResultMetric) -> Shares:
    words = {True: "yes", False: "no", None: "none"}
    texts = [
        words.get(v, v) if isinstance(v, bool) or v is None else v for v in fleet.texts(figure.name)
    ]
    return Shares(figure, tuple(Counter(map(str, texts)).most_common()))


def _outliers(fleet: FleetFile, looks: tuple[Look, ...]) -> tuple[Outlier, ...]:
    found = [
        Outlier(
            fleet.logs[look.rows[i]],
            look.figure.name,
            float(look.values[i]),
            float(look.spread.z[look.rows[i]]),
            float(look.spread.p[look.rows[i]]),
        )
        for look in looks
        for i in np.flatnonzero(look.outlying)
    ]
    return tuple(sorted(found, key=lambda o: (o.p, -abs(o.z), o.log)))


def failures(logs: tuple[str, ...], errors: tuple[str | None, ...]) -> tuple[Failure, ...]:
    """Errors grouped by what they say, the most frequent first."""
    groups: dict[str, list[str]] = {}
    for log, error in zip(logs, errors, strict=True):
        if error:
            groups.setdefault(kind_of(error, log), []).append(log)
    ranked = sorted(groups.items(), key=lambda item: (-len(item[1]), item[0]))
    return tuple(Failure(m, len(found), tuple(found[:EXAMPLES])) for m, found in ranked)


def kind_of(error: str, log: str) -> str:
    """The message less what is of this log alone: its names and all numbers.

    Its name without the ending counts from three characters on that are no number: a shorter one is
    too easily a word or a unit.

    >>> kind_of("a/run7.csv: ends at 3.2 s; expected 5 s", "a/run7.csv")
    'LOG: ends at # s; expected # s'
    """
    name = re.split(r"[/\\]", log)[-1]
    stem = name.rpartition(".")[0]
    own = [log, name] + [stem] * (len(stem) >= SHORTEST and not stem.isdecimal())
    for text in filter(None, own):
        error = re.sub(rf"""([^\s'"]*[/\\])?(?<![\w-]){re.escape(text)}(?![\w-])""", "LOG", error)
    return re.sub(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)", "#", error)
