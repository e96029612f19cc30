"""Summary of a fleet: scatter, outliers, drift of the line, errors by kind."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.plain import counted, plain
from calib.line.fleet.drift import LevelChange, find_change
from calib.line.fleet.outliers import SHARE, OutlierTest, discoveries, find_outliers
from calib.line.fleet.results import FleetFile
from calib.line.fleet.rows import Column, Status

_DRIFT = 0.01
"""Expected share of false ones among the metrics with a drift [1]."""

_MAD = 0.67449
"""Median absolute deviation of a normal distribution of sigma 1."""

_P_OF_3 = 0.0027
"""Two-sided p of 3 sigma."""

_MANY = 20
"""A text column with more different values than this is not a class: names, digests."""

_EXAMPLES = 3
"""Most logs that are named for a kind of error."""


@dataclass(frozen=True)
class Outlier:
    """A metric for which a log is an outlier: ``p`` two-sided, ``z`` normal deviate of that p."""

    log: str
    figure: str
    value: float
    z: float
    p: float


@dataclass(frozen=True)
class _OutlyingLog:
    """An outlier: ``p`` over all metrics of a log, and its reasons, the strongest first."""

    log: str
    p: float
    reasons: tuple[Outlier, ...]


@dataclass(frozen=True)
class MetricSummary:
    """One metric, a number, over the k logs of the fleet that have it.

    ``rows`` of these logs, ``values``, two-sided ``p``, NaN if not judged, and ``outlying``, all
    (k,); ``change`` None for too few; ``drifts`` whether it is significant among all metrics.
    """

    column: Column
    rows: Index
    values: Array
    p: Array
    outlying: Mask
    change: LevelChange | None
    drifts: bool

    @property
    def name(self) -> str:
        """The plain name of the metric."""
        return plain(self.column.name, self.column.unit).name

    @property
    def judged(self) -> bool:
        """Whether there are enough values for outliers."""
        return bool(np.isfinite(self.p).any())

    @property
    def median(self) -> float:
        """Median in the metric's unit; NaN without a value, and so are scale and quantiles."""
        return float(np.median(self._values))

    @property
    def scale(self) -> float:
        """Standard deviation of a normal distribution with the same median deviation."""
        return float(np.median(np.abs(self._values - self.median))) / _MAD

    @property
    def quantiles(self) -> dict[str, float]:
        """Quantiles 5, 25, 75 and 95 %."""
        shares = ("5", "25", "75", "95")
        quantiles = np.quantile(self._values, [0.05, 0.25, 0.75, 0.95]).tolist()
        return dict(zip(shares, quantiles, strict=True))

    @property
    def _values(self) -> Array:
        return self.values if self.values.size else np.full(1, np.nan)

    @property
    def inlier_range(self) -> tuple[float, float]:
        """Quantiles 5 and 95 % of the values without outliers; of all if each is one."""
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

    ``status`` number of logs for each; ``failed`` logs that fail, each with the limits that it does
    not hold, "" where that is not known; ``classes`` of each metric of text or yes/no the number of
    each value, the most frequent first; ``apart`` outliers, the farthest first; ``copies`` names of
    logs that are the same recording, by recording.
    """

    logs: tuple[str, ...]
    ordered_by: str
    status: dict[Status, int]
    failed: dict[str, str]
    metrics: tuple[MetricSummary, ...]
    classes: dict[str, dict[str, int]]
    apart: tuple[_OutlyingLog, ...]
    failures: tuple[_Failure, ...]
    copies: list[list[str]]

    @property
    def drift_tested(self) -> bool:
        """Whether any metric has enough logs to test for drift."""
        return any(metric.change is not None for metric in self.metrics)

    @property
    def headline(self) -> str:
        """The fleet in one sentence."""
        errors = sum(failure.count for failure in self.failures)
        failed = f"; {counted(errors, 'log')} with an error" if errors else ""
        if not any(metric.judged for metric in self.metrics):
            some = any(metric.values.size for metric in self.metrics)
            why = "too few to judge outliers or drift" if some else "none has a metric"
            return f"{counted(len(self.logs), 'log')}: {why}{failed}."
        names, logs = [m.name for m in self.metrics if m.drifts], len(self.apart)
        drift = "No drift" if self.drift_tested else "Drift not tested"
        if names:
            drift = f"{', '.join(names)} {'drift' if len(names) > 1 else 'drifts'}"
        apart = f"{counted(logs, 'log')} {'stands' if logs == 1 else 'stand'}"
        return f"{drift}; {apart if logs else 'no log stands'} apart{failed}."


def summarise(fleet: FleetFile) -> Summary:
    """Summarise all metrics that are numbers."""
    numbers = [m for m in fleet.metrics if m.kind is float]
    every = np.array([fleet.numbers(m.name) for m in numbers]).reshape(-1, len(fleet.logs))
    test = find_outliers(every, [plain(m.name).step for m in numbers])
    rows = [np.flatnonzero(np.isfinite(x)) for x in every]
    # the column that orders the line increases along it by itself: it is not tested
    lines = [x[:0] if m.name == fleet.order else x for m, x in zip(numbers, every, strict=True)]
    changes = drift_tests([x[np.isfinite(x)] for x in lines])
    metrics = [
        MetricSummary(m, k, every[i, k], test.p[i, k], test.reasons[i, k], *changes[i])
        for i, (m, k) in enumerate(zip(numbers, rows, strict=True))
    ]
    words = fleet.values("status")
    status = Counter(words)
    verdicts = zip_longest(fleet.logs, words, fleet.values("not_held"))
    recordings: dict[object, list[str]] = {}
    for log, digest in zip(fleet.logs, fleet.values("digest"), strict=False):
        recordings.setdefault(log if digest is None else digest, []).append(log)
    return Summary(
        fleet.logs,
        fleet.ordered_by,
        {name: status[name] for name in Status if status[name]},
        {log: str(why or "") for log, word, why in verdicts if word == Status.FAILED},
        tuple(metrics),
        dict(_classes(fleet)),
        _outlying_logs(fleet.logs, numbers, every, test),
        failures(fleet.logs, fleet.values("error")),
        [copies for copies in recordings.values() if len(copies) > 1],
    )


def drift_tests(lines: Sequence[Array]) -> list[tuple[LevelChange | None, bool]]:
    """Change of each metric in the order of the line, and whether it is significant among all."""
    changes = [find_change(x) for x in lines]
    p = np.array([np.nan if c is None else c.p for c in changes])
    return list(zip(changes, discoveries(p, _DRIFT).tolist(), strict=True))


def _classes(fleet: FleetFile) -> Iterator[tuple[str, dict[str, int]]]:
    words: dict[object, str] = {True: "yes", False: "no", None: "none"}
    for metric in (m for m in fleet.metrics if m.kind is not float):
        counts = Counter(words.get(v, str(v)) for v in fleet.values(metric.name))
        if metric.kind is bool or len(counts) <= _MANY:
            yield metric.name, dict(counts.most_common())


def _outlying_logs(
    logs: tuple[str, ...], metrics: Sequence[Column], values: Array, test: OutlierTest
) -> tuple[_OutlyingLog, ...]:
    """The outliers, each with its reasons; ``values`` (m, n)."""
    from scipy.special import ndtri

    if not test.reasons.any():
        return ()
    deviation = values - np.nanmedian(values, axis=1, keepdims=True)
    z = -np.sign(deviation) * ndtri(np.maximum(0.5 * test.p, 1e-19))
    numbers, cars = np.stack([values, z, test.p]), []
    for row in np.flatnonzero(test.reasons.any(axis=0)):
        reasons = [
            Outlier(logs[row], metrics[i].name, *numbers[:, i, row].tolist())
            for i in np.flatnonzero(test.reasons[:, row]).tolist()
        ]
        reasons.sort(key=lambda o: (o.p, -abs(o.z)))
        cars.append(_OutlyingLog(logs[row], float(test.p_of_car[row]), tuple(reasons)))
    return tuple(sorted(cars, key=lambda car: (car.p, car.log)))


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


def document(summary: Summary) -> dict[str, Any]:
    """The whole summary as one JSON-able document."""
    reasons = [reason for car in summary.apart for reason in car.reasons]
    return {
        "schema": 1,
        "logs": len(summary.logs),
        "ordered_by": summary.ordered_by,
        "status": summary.status,
        "headline": summary.headline,
        "failed": summary.failed,
        "errors": summary.failures,
        "copies": summary.copies,
        "outliers": sorted(reasons, key=lambda o: (o.p, -abs(o.z), o.log)),
        "outliers_by_chance": SHARE * len(reasons),
        "apart": [
            {"log": car.log, "p": car.p, "figures": [o.figure for o in car.reasons]}
            for car in summary.apart
        ],
        "figures": {m.column.name: _entry(summary, m) for m in summary.metrics},
        "classes": summary.classes,
    }


def _entry(summary: Summary, metric: MetricSummary) -> dict[str, Any]:
    c = metric.change
    return {
        "unit": metric.column.unit,
        "count": metric.values.size,
        "median": metric.median,
        "scale": metric.scale,
        "quantiles": metric.quantiles,
        "beyond_3": int(np.sum(metric.p < _P_OF_3)),
        "outliers": int(metric.outlying.sum()),
        "change": c
        and {
            "drifts": metric.drifts,
            "p": c.p,
            "first_log": summary.logs[metric.rows[c.first]],
            "number": int(metric.rows[c.first]) + 1,
            "before": c.old_level,
            "after": c.new_level,
        },
    }
