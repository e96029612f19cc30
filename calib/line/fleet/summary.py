"""Summary of a fleet: scatter, outliers, errors by kind."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.plain import counted, metric_of
from calib.line.fleet.outliers import find_outliers
from calib.line.fleet.results import FleetFile
from calib.line.fleet.rows import Column, Status

_MAD = 0.67449
"""Median absolute deviation of a normal distribution of sigma 1."""

_EXAMPLES = 3
"""Most logs that are named for a kind of error."""


@dataclass(frozen=True)
class Outlier:
    """A metric for which a log is an outlier: its ``value``, and its two-sided ``p``."""

    log: str
    figure: str
    value: float
    p: float


@dataclass(frozen=True)
class MetricSummary:
    """One metric, a number, over the k logs of the fleet that have it.

    ``rows`` of these logs, ``values``, and ``outlying``, all (k,); ``judged`` whether there are
    enough values for outliers.
    """

    column: Column
    rows: Index
    values: Array
    outlying: Mask
    judged: bool

    @property
    def name(self) -> str:
        """The plain name of the metric."""
        return metric_of(self.column.name, self.column.unit).name

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
    not hold, "" where that is not known; ``apart`` the reasons of each outlier, the strongest first
    and the farthest log first; ``copies`` names of logs that are the same recording, by recording.
    """

    logs: tuple[str, ...]
    status: dict[Status, int]
    failed: dict[str, str]
    metrics: tuple[MetricSummary, ...]
    apart: dict[str, list[Outlier]]
    failures: tuple[_Failure, ...]
    copies: list[list[str]]

    @property
    def judged(self) -> bool:
        """Whether any metric has enough values for outliers."""
        return any(metric.judged for metric in self.metrics)

    @property
    def headline(self) -> str:
        """The fleet in one sentence."""
        errors = sum(failure.count for failure in self.failures)
        failed = f"; {counted(errors, 'log')} with an error" if errors else ""
        if not self.judged:
            some = any(metric.values.size for metric in self.metrics)
            why = "too few to judge outliers" if some else "none has a metric"
            return f"{counted(len(self.logs), 'log')}: {why}{failed}."
        n = len(self.apart)
        apart = f"{counted(n, 'log')} {'stands' if n == 1 else 'stand'}" if n else "No log stands"
        return f"{apart} apart{failed}."


def summarise(fleet: FleetFile) -> Summary:
    """Summarise all metrics that are numbers."""
    numbers = [m for m in fleet.metrics if m.kind is float]
    every = np.array([fleet.numbers(m.name) for m in numbers]).reshape(-1, len(fleet.logs))
    test = find_outliers(every, [metric_of(m.name).step for m in numbers])
    metrics = []
    for m, x, p, outlying in zip(numbers, every, test.p, test.reasons, strict=True):
        rows = np.flatnonzero(np.isfinite(x))
        judged = bool(np.isfinite(p).any())
        metrics.append(MetricSummary(m, rows, x[rows], outlying[rows], judged))
    apart = dict[str, list[Outlier]]()
    for row in sorted(np.flatnonzero(test.reasons.any(axis=0)), key=test.p_of_car.__getitem__):
        reasons = [
            Outlier(fleet.logs[row], numbers[i].name, float(every[i, row]), float(test.p[i, row]))
            for i in np.flatnonzero(test.reasons[:, row])
        ]
        apart[fleet.logs[row]] = sorted(reasons, key=lambda outlier: outlier.p)
    words = fleet.values("status")
    status = Counter(words)
    verdicts = zip_longest(fleet.logs, words, fleet.values("not_held"))
    recordings: dict[object, list[str]] = {}
    for log, digest in zip(fleet.logs, fleet.values("digest"), strict=False):
        recordings.setdefault(log if digest is None else digest, []).append(log)
    return Summary(
        fleet.logs,
        {name: status[name] for name in Status if status[name]},
        {log: str(why or "") for log, word, why in verdicts if word == Status.FAILED},
        tuple(metrics),
        apart,
        failures(fleet.logs, fleet.values("error")),
        [copies for copies in recordings.values() if len(copies) > 1],
    )


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
    return {
        "schema": 1,
        "logs": len(summary.logs),
        "status": summary.status,
        "headline": summary.headline,
        "failed": summary.failed,
        "errors": summary.failures,
        "copies": summary.copies,
        "outliers": sorted(
            (reason for reasons in summary.apart.values() for reason in reasons),
            key=lambda outlier: (outlier.p, outlier.log),
        ),
        "figures": {
            m.column.name: {
                "unit": m.column.unit,
                "count": m.values.size,
                "median": m.median,
                "scale": m.scale,
                "quantiles": m.quantiles,
                "outliers": int(m.outlying.sum()),
            }
            for m in summary.metrics
        },
    }
