"""Summary of a fleet's results: spread, outliers, drift of the line, errors by kind."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.errors import InputError
from calib.base.plain import counted, plain
from calib.base.toml import did_you_mean
from calib.line.fleet import drift, outliers
from calib.line.fleet.drift import LevelChange, change, least_p
from calib.line.fleet.outliers import SHARE, MetricSpread, judge, named
from calib.line.fleet.results import FleetFile
from calib.line.fleet.rows import Column, Status

_DRIFT = 0.01
"""Expected share of false ones among the metrics with a drift [1]."""

_EXAMPLES = 3
"""Most logs that are named for a kind of error."""

_MANY = 20
"""A text column with more different values than this is not a class: names, digests."""


@dataclass(frozen=True)
class Outlier:
    """A reason why a log stands apart: a metric, its value, its z and two-sided p."""

    log: str
    figure: str
    value: float
    z: float
    p: float


@dataclass(frozen=True)
class _Apart:
    """A log that stands apart: ``p`` over all its metrics, and its reasons, the strongest first."""

    log: str
    p: float
    reasons: tuple[Outlier, ...]


@dataclass(frozen=True)
class MetricSummary:
    """One metric, a number, over the fleet.

    ``rows`` (k,) with a value, in order; ``values`` (k,); ``change`` None if too few for a
    significant one among so many metrics; ``drifts`` whether it is significant among all metrics.
    """

    column: Column
    rows: Index
    values: Array
    spread: MetricSpread
    change: LevelChange | None
    drifts: bool
    outlying: Mask

    @property
    def name(self) -> str:
        """The plain name of the metric."""
        return plain(self.column.name, self.column.unit).name

    @property
    def others(self) -> tuple[float, float]:
        """5 and 95 % of the values that stand not apart; of all if none or each does."""
        inliers = self.values[~self.outlying]
        low, high = np.quantile(inliers if inliers.size else self.values, [0.05, 0.95])
        return float(low), float(high)


@dataclass(frozen=True)
class _Failure:
    """Errors of one kind: the ``message`` of the first, their ``count``, some of their ``logs``.

    Messages that differ only in names and numbers are of one kind.
    """

    message: str
    count: int
    logs: tuple[str, ...]


@dataclass(frozen=True)
class Summary:
    """The whole fleet.

    ``status``: number of logs for each; ``failed``: logs that fail, each with the limits that it
    does not hold, "" where that is not known; ``classes``: of each metric of text or yes/no the
    number of each value, the most frequent first; ``apart``: the farthest log first; ``copies``:
    names of logs that are one and the same recording, by recording.
    """

    logs: tuple[str, ...]
    ordered_by: str
    status: dict[Status, int]
    failed: dict[str, str]
    looks: tuple[MetricSummary, ...]
    classes: dict[str, dict[str, int]]
    apart: tuple[_Apart, ...]
    failures: tuple[_Failure, ...]
    copies: list[list[str]]

    @property
    def outliers(self) -> tuple[Outlier, ...]:
        """All reasons of all logs that stand apart, the strongest first."""
        reasons = [reason for car in self.apart for reason in car.reasons]
        return tuple(sorted(reasons, key=lambda o: (o.p, -abs(o.z), o.log)))

    @property
    def too_few(self) -> bool:
        """Whether no metric has enough logs to be judged."""
        counts = [look.spread.count for look in self.looks]
        return max(counts, default=0) < min(outliers.FEWEST, drift.FEWEST)

    @property
    def drift_tested(self) -> bool:
        """Whether any metric has enough logs to tell a drift."""
        return any(look.change is not None for look in self.looks)


def summarise(fleet: FleetFile, wanted: tuple[str, ...] = ()) -> Summary:
    """Summarise all metrics, or only those ``wanted``. Raises InputError for an unknown one."""
    metrics = _chosen(fleet, wanted)
    numbers = [m for m in metrics if m.kind is float]
    every = np.array([fleet.numbers(m.name) for m in numbers]).reshape(
        len(numbers), len(fleet.logs)
    )
    judged = judge(every, [plain(m.name).step for m in numbers])
    rows = [np.flatnonzero(np.isfinite(x)) for x in every]
    values = [x[known] for x, known in zip(every, rows, strict=True)]
    # the column that orders the line always increases along it
    along = [i for i, m in enumerate(numbers) if m.name != fleet.ordered_by]
    drifts = zip(*drifting([values[i] for i in along]), strict=True)
    changes = dict(zip(along, drifts, strict=True))
    looks = tuple(
        MetricSummary(
            m,
            rows[i],
            values[i],
            judged.spreads[i],
            *changes.get(i, (None, False)),
            judged.named[i][rows[i]],
        )
        for i, m in enumerate(numbers)
    )
    words, digests = fleet.values("status"), fleet.values("digest")
    status = Counter(words)
    verdicts = zip_longest(fleet.logs, words, fleet.values("not_held"))
    return Summary(
        fleet.logs,
        fleet.ordered_by,
        {name: status[name] for name in Status if status[name]},
        {log: str(why or "") for log, word, why in verdicts if word == Status.FAILED},
        looks,
        dict(_classes(fleet, metrics)),
        _apart(fleet, looks, judged.p),
        failures(fleet.logs, fleet.values("error")),
        [same for same in _grouped(fleet.logs, digests).values() if len(same) > 1],
    )


def drifting(lines: Sequence[Array]) -> tuple[list[LevelChange | None], list[bool]]:
    """Change of each metric in the order of the line, and whether it is significant among all.

    None if even a clear step could not be significant.
    """
    changes = [change(x) for x in lines]
    enough = _DRIFT / max(sum(c is not None for c in changes), 1)
    tested = [
        c if c and least_p(x.size) <= enough else None for c, x in zip(changes, lines, strict=True)
    ]
    p = np.array([c.p if c else np.nan for c in tested])
    return tested, named(p, _DRIFT).tolist()


def _chosen(fleet: FleetFile, wanted: tuple[str, ...]) -> tuple[Column, ...]:
    by_name = {metric.name: metric for metric in fleet.metrics}
    for name in (name for name in wanted if name not in by_name):
        names, near = f"one of {', '.join(by_name)}", did_you_mean(name, by_name)
        raise InputError(f"no metric {name!r}", where=fleet.path, expected=names, do=near)
    return tuple(by_name[name] for name in wanted) or fleet.metrics


def _classes(fleet: FleetFile, metrics: tuple[Column, ...]) -> Iterator[tuple[str, dict[str, int]]]:
    words: dict[object, str] = {True: "yes", False: "no", None: "none"}
    for metric in (m for m in metrics if m.kind is not float):
        counts = Counter(words.get(v, str(v)) for v in fleet.values(metric.name))
        if metric.kind is bool or len(counts) <= _MANY:
            yield metric.name, dict(counts.most_common())


def _apart(fleet: FleetFile, looks: tuple[MetricSummary, ...], p: Array) -> tuple[_Apart, ...]:
    """The logs that stand apart, each with its metrics; ``p`` (n,) of all logs."""
    reasons: dict[int, list[Outlier]] = {}
    for look in looks:
        for value, row in zip(look.values[look.outlying], look.rows[look.outlying], strict=True):
            numbers = float(value), float(look.spread.z[row]), float(look.spread.p[row])
            outlier = Outlier(fleet.logs[row], look.column.name, *numbers)
            reasons.setdefault(int(row), []).append(outlier)
    cars = [
        _Apart(fleet.logs[row], float(p[row]), tuple(sorted(why, key=lambda o: (o.p, -abs(o.z)))))
        for row, why in reasons.items()
    ]
    return tuple(sorted(cars, key=lambda car: (car.p, -abs(car.reasons[0].z), car.log)))


def failures(logs: tuple[str, ...], errors: Sequence[object]) -> tuple[_Failure, ...]:
    """Errors grouped by kind, the most frequent first."""
    kinds = [
        kind_of(error, log) if isinstance(error, str) else None
        for log, error in zip(logs, errors, strict=True)
    ]
    messages = dict(zip(reversed(kinds), reversed(errors), strict=True))
    ranked = sorted(_grouped(logs, kinds).items(), key=lambda kind: (-len(kind[1]), kind[0]))
    return tuple(_Failure(str(messages[k]), len(g), tuple(g[:_EXAMPLES])) for k, g in ranked)


def _grouped(logs: tuple[str, ...], keys: Sequence[object]) -> dict[str, list[str]]:
    """The logs by their keys, in their order; None is no key."""
    groups: dict[str, list[str]] = {}
    for log, key in zip(logs, keys, strict=False):
        if key is not None:
            groups.setdefault(str(key), []).append(log)
    return groups


def kind_of(error: str, log: str) -> str:
    """The message without the name of this log and without numbers.

    >>> kind_of("a/run7.csv: ends at 3.2 s; expected 5 s", "a/run7.csv")
    'LOG: ends at # s; expected # s'
    """
    for name in filter(None, (log, re.split(r"[/\\]", log)[-1])):
        error = error.replace(name, "LOG")
    return re.sub(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)", "#", error)


def headline(summary: Summary) -> str:
    """The fleet in one sentence."""
    errors = sum(failure.count for failure in summary.failures)
    failed = f"; {counted(errors, 'log')} with an error" if errors else ""
    if summary.too_few:
        some = any(look.spread.count for look in summary.looks)
        why = "too few to judge outliers or drift" if some else "none has a metric"
        return f"{counted(len(summary.logs), 'log')}: {why}{failed}."
    names, logs = [look.name for look in summary.looks if look.drifts], len(summary.apart)
    drift = "No drift" if summary.drift_tested else "Drift not tested"
    if names:
        drift = f"{', '.join(names)} {'drift' if len(names) > 1 else 'drifts'}"
    apart = f"{counted(logs, 'log')} {'stands' if logs == 1 else 'stand'}"
    return f"{drift}; {apart if logs else 'no log stands'} apart{failed}."


def document(summary: Summary) -> dict[str, Any]:
    """The whole summary as one JSON-able document."""
    return {
        "schema": 1,
        "logs": len(summary.logs),
        "ordered_by": summary.ordered_by,
        "status": summary.status,
        "headline": headline(summary),
        "failed": summary.failed,
        "errors": summary.failures,
        "copies": summary.copies,
        "outliers": summary.outliers,
        "outliers_by_chance": SHARE * len(summary.outliers),
        "apart": [
            {"log": car.log, "p": car.p, "figures": [o.figure for o in car.reasons]}
            for car in summary.apart
        ],
        "figures": {look.column.name: _entry(summary, look) for look in summary.looks},
        "classes": summary.classes,
    }


def _entry(summary: Summary, look: MetricSummary) -> dict[str, Any]:
    s, c = look.spread, look.change
    return {
        "unit": look.column.unit,
        "count": s.count,
        "median": s.median,
        "scale": s.scale,
        "quantiles": dict(zip(("5", "25", "75", "95"), s.quantiles, strict=True)),
        "beyond_3": int(np.sum(np.abs(s.z) > 3.0)),
        "outliers": int(look.outlying.sum()),
        "change": c
        and {
            "drifts": look.drifts,
            "p": c.p,
            "first_log": summary.logs[look.rows[c.first]],
            "number": int(look.rows[c.first]) + 1,
            "before": c.old_level,
            "after": c.new_level,
        },
    }
