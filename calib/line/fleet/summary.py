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
from calib.line.fleet.drift import LevelChange, change, least_p
from calib.line.fleet.outliers import FEWEST, SHARE, Judged, judge, named
from calib.line.fleet.results import FleetFile
from calib.line.fleet.rows import Column, Status

_DRIFT = 0.01
"""Expected share of false ones among the metrics with a drift [1]."""

_MAD = 0.67449
"""Median absolute deviation of a normal distribution of sigma 1."""

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

    ``rows`` (k,) with a value, in order; ``values``, their ``z`` and ``outlying`` (k,); ``change``
    None if too few for a significant one among so many metrics; ``drifts`` whether it is
    significant among all metrics.
    """

    column: Column
    rows: Index
    values: Array
    z: Array
    outlying: Mask
    change: LevelChange | None
    drifts: bool

    @property
    def name(self) -> str:
        """The plain name of the metric."""
        return plain(self.column.name, self.column.unit).name

    @property
    def median(self) -> float:
        """In the metric's unit; NaN without a value, and so are scale and quantiles."""
        return float(np.median(self._values))

    @property
    def scale(self) -> float:
        """Standard deviation of a normal distribution with the same median deviation."""
        return float(np.median(np.abs(self._values - self.median))) / _MAD

    @property
    def quantiles(self) -> dict[str, float]:
        """The values below which 5, 25, 75 and 95 % are, by percent."""
        shares = ("5", "25", "75", "95")
        quantiles = np.quantile(self._values, [0.05, 0.25, 0.75, 0.95]).tolist()
        return dict(zip(shares, quantiles, strict=True))

    @property
    def _values(self) -> Array:
        return self.values if self.values.size else np.full(1, np.nan)

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
        return all(look.values.size < FEWEST for look in self.looks)

    @property
    def drift_tested(self) -> bool:
        """Whether any metric has enough logs to tell a drift."""
        return any(look.change is not None for look in self.looks)


def summarise(fleet: FleetFile, wanted: tuple[str, ...] = ()) -> Summary:
    """Summarise all metrics, or only those ``wanted``. Raises InputError for an unknown one."""
    metrics = _chosen(fleet, wanted)
    numbers = [m for m in metrics if m.kind is float]
    every = np.array([fleet.numbers(m.name) for m in numbers]).reshape(-1, len(fleet.logs))
    judged = judge(every, [plain(m.name).step for m in numbers])
    finite = np.isfinite(every)
    lines = list(zip(numbers, every, finite, strict=True))
    # the column that orders the line always increases along it: nothing of it is tested
    drifts = drifting([x[k] if m.name != fleet.order else x[:0] for m, x, k in lines])
    looks = tuple(
        MetricSummary(m, np.flatnonzero(k), x[k], judged.z[i, k], judged.named[i, k], *drifts[i])
        for i, (m, x, k) in enumerate(lines)
    )
    words = fleet.values("status")
    status = Counter(words)
    verdicts = zip_longest(fleet.logs, words, fleet.values("not_held"))
    recordings: dict[object, list[str]] = {}
    for log, digest in zip(fleet.logs, fleet.values("digest"), strict=False):
        if digest is not None:
            recordings.setdefault(digest, []).append(log)
    return Summary(
        fleet.logs,
        fleet.ordered_by,
        {name: status[name] for name in Status if status[name]},
        {log: str(why or "") for log, word, why in verdicts if word == Status.FAILED},
        looks,
        dict(_classes(fleet, metrics)),
        _apart(fleet.logs, numbers, every, judged),
        failures(fleet.logs, fleet.values("error")),
        [copies for copies in recordings.values() if len(copies) > 1],
    )


def drifting(lines: Sequence[Array]) -> list[tuple[LevelChange | None, bool]]:
    """Change of each metric in the order of the line, and whether it is significant among all.

    None if even a clear step could not be significant.
    """
    changes = [change(x) for x in lines]
    enough = _DRIFT / max(sum(c is not None for c in changes), 1)
    tested = [
        c if c and least_p(x.size) <= enough else None for c, x in zip(changes, lines, strict=True)
    ]
    p = np.array([c.p if c else np.nan for c in tested])
    return list(zip(tested, named(p, _DRIFT).tolist(), strict=True))


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


def _apart(
    logs: tuple[str, ...], metrics: Sequence[Column], values: Array, judged: Judged
) -> tuple[_Apart, ...]:
    """The logs that stand apart, each with its metrics; ``values`` (m, n)."""
    numbers, cars = np.stack([values, judged.z, judged.p]), []
    for row in np.flatnonzero(judged.named.any(axis=0)):
        reasons = [
            Outlier(logs[row], metrics[i].name, *numbers[:, i, row].tolist())
            for i in np.flatnonzero(judged.named[:, row]).tolist()
        ]
        reasons.sort(key=lambda o: (o.p, -abs(o.z)))
        cars.append(_Apart(logs[row], float(judged.p_of_car[row]), tuple(reasons)))
    return tuple(sorted(cars, key=lambda car: (car.p, -abs(car.reasons[0].z), car.log)))


def failures(logs: tuple[str, ...], errors: Sequence[object]) -> tuple[_Failure, ...]:
    """Errors grouped by kind, the most frequent first."""
    kinds: dict[str, list[tuple[str, str]]] = {}
    for log, error in zip(logs, errors, strict=True):
        if isinstance(error, str):
            kinds.setdefault(kind_of(error, log), []).append((error, log))
    ranked = sorted(kinds.items(), key=lambda kind: (-len(kind[1]), kind[0]))
    return tuple(
        _Failure(group[0][0], len(group), tuple(log for _, log in group[:_EXAMPLES]))
        for _, group in ranked
    )


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
        some = any(look.values.size for look in summary.looks)
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
    c = look.change
    return {
        "unit": look.column.unit,
        "count": look.values.size,
        "median": look.median,
        "scale": look.scale,
        "quantiles": look.quantiles,
        "beyond_3": int(np.sum(np.abs(look.z) > 3.0)),
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
