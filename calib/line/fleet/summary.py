"""Summary of a fleet: the scatter of each metric, the outliers, and the errors by kind."""

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.plain import counted, metric_of
from calib.line.fleet.outliers import OutlierTest, find_outliers
from calib.line.fleet.results import FleetFile
from calib.line.fleet.rows import Column, Status

_MAD = 0.67449  # median absolute deviation of the normal distribution with sigma 1
_EXAMPLES = 3  # largest number of logs that are named for a kind of error


@dataclass(frozen=True)
class Outlier:
    """A log that is an outlier in a metric."""

    log: str
    figure: str  # name of the metric
    value: float
    p: float  # two-sided


@dataclass(frozen=True)
class MetricSummary:
    """One metric over the k logs of the fleet that have a number of it."""

    column: Column
    rows: Index  # of these logs in the fleet, (k,)
    values: Array  # (k,)
    outlying: Mask  # whether a log is an outlier, (k,)
    judged: bool  # whether there are enough values to find outliers

    @property
    def name(self) -> str:
        """The plain name of the metric."""
        return metric_of(self.column.name, self.column.unit).name

    @property
    def median(self) -> float:
        """The median in the metric's unit. Without a value it is NaN, as scale and quantiles."""
        return float(np.median(self._values))

    @property
    def scale(self) -> float:
        """Standard deviation of a normal distribution with the same median absolute deviation."""
        return float(np.median(np.abs(self._values - self.median))) / _MAD

    @property
    def quantiles(self) -> dict[str, float]:
        """The quantiles 5, 25, 75 and 95 % by their percentage."""
        return {str(x): float(np.quantile(self._values, x / 100.0)) for x in (5, 25, 75, 95)}

    @property
    def _values(self) -> Array:
        """The values, or one NaN without a value."""
        return self.values if self.values.size else np.full(1, np.nan)

    @property
    def inlier_range(self) -> tuple[float, float]:
        """The quantiles 5 and 95 % of the inliers, or of all values if all are outliers."""
        inliers = self.values[~self.outlying]
        low, high = np.quantile(inliers if inliers.size else self.values, [0.05, 0.95])
        return float(low), float(high)


@dataclass(frozen=True)
class _Failure:
    """Errors of one kind, whose messages differ only in names and numbers."""

    message: str  # of the first error
    count: int
    logs: tuple[str, ...]  # the first of the logs


@dataclass(frozen=True)
class Summary:
    """Summary of the whole fleet."""

    logs: tuple[str, ...]
    status: dict[Status, int]  # number of logs
    failed: dict[str, str]  # limits not held by each log that fails; "" if they are not known
    metrics: tuple[MetricSummary, ...]
    outliers: dict[str, list[Outlier]]  # metrics by log; both are sorted, the least p first
    failures: tuple[_Failure, ...]
    copies: list[list[str]]  # groups of logs that are the same recording

    @property
    def judged(self) -> bool:
        """Whether any metric has enough values for outliers."""
        return any(metric.judged for metric in self.metrics)

    @property
    def headline(self) -> str:
        """The fleet in one sentence."""
        errors = sum(failure.count for failure in self.failures)
        with_error = f"; {counted(errors, 'log')} with an error" if errors else ""
        if not self.judged:
            has_values = any(metric.values.size for metric in self.metrics)
            reason = "too few to judge outliers" if has_values else "none has a metric"
            return f"{counted(len(self.logs), 'log')}: {reason}{with_error}."
        n = len(self.outliers)
        verb = "stand" if n > 1 else "stands"
        return f"{counted(n, 'log') if n else 'No log'} {verb} apart{with_error}."


def summarise(fleet: FleetFile) -> Summary:
    """Return the summary of the results of a batch; its metrics are the columns of numbers."""
    numbers = [metric for metric in fleet.metrics if metric.kind is float]
    # (metrics, logs); the shape is also right without a metric
    values = np.array([fleet.numbers(m.name) for m in numbers]).reshape(-1, len(fleet.logs))
    test = find_outliers(values, [metric_of(metric.name).step for metric in numbers])
    metrics = []
    for column, x, p, outlying in zip(numbers, values, test.p, test.reasons, strict=True):
        rows, judged = np.flatnonzero(np.isfinite(x)), bool(np.isfinite(p).any())
        metrics.append(MetricSummary(column, rows, x[rows], outlying[rows], judged))
    statuses = fleet.values("status")
    counts = Counter(statuses)
    not_held = fleet.values("not_held") or [None] * len(fleet.logs)  # `check` has no such column
    outcomes = zip(fleet.logs, statuses, not_held, strict=True)
    return Summary(
        logs=fleet.logs,
        status={status: counts[status] for status in Status if counts[status]},
        failed={log: limits or "" for log, status, limits in outcomes if status == Status.FAILED},
        metrics=tuple(metrics),
        outliers=_outliers(fleet.logs, numbers, values, test),
        failures=failures_of(fleet.logs, fleet.values("error")),
        copies=_copies(fleet),
    )


def _outliers(
    logs: tuple[str, ...], columns: list[Column], values: Array, test: OutlierTest
) -> dict[str, list[Outlier]]:
    """Return `Summary.outliers` from the ``values`` (m, n) of m metrics of n logs."""
    outliers: dict[str, list[Outlier]] = {}
    rows = np.flatnonzero(test.reasons.any(axis=0))
    for row in sorted(rows, key=test.p_of_car.__getitem__):
        reasons = [
            Outlier(logs[row], columns[i].name, float(values[i, row]), float(test.p[i, row]))
            for i in np.flatnonzero(test.reasons[:, row])
        ]
        outliers[logs[row]] = sorted(reasons, key=lambda reason: reason.p)
    return outliers


def _copies(fleet: FleetFile) -> list[list[str]]:
    """Return the groups of logs with the same digest."""
    by_digest = defaultdict(list)
    for log, digest in zip(fleet.logs, fleet.values("digest"), strict=False):
        by_digest[digest].append(log)
    return [logs for digest, logs in by_digest.items() if digest is not None and len(logs) > 1]


def failures_of(logs: tuple[str, ...], errors: Sequence[object]) -> tuple[_Failure, ...]:
    """Return the errors grouped by kind, the most frequent kind first."""
    kinds = defaultdict(list)
    for log, error in zip(logs, errors, strict=True):
        if isinstance(error, str):
            kinds[kind_of(error, log)].append((error, log))
    failures = []
    for _, errors_of_kind in sorted(kinds.items(), key=lambda item: (-len(item[1]), item[0])):
        messages, names = zip(*errors_of_kind, strict=True)
        failures.append(_Failure(messages[0], len(messages), names[:_EXAMPLES]))
    return tuple(failures)


def kind_of(error: str, log: str) -> str:
    """Return a message without the name of its log and without numbers.

    >>> kind_of("a/run7.csv: ends at 3.2 s; expected 5 s", "a/run7.csv")
    'LOG: ends at # s; expected # s'
    """
    for name in filter(None, (log, re.split(r"[/\\]", log)[-1])):
        error = error.replace(name, "LOG")
    # a number that does not touch a letter, a digit or a point of a name
    return re.sub(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)", "#", error)


def document(summary: Summary) -> dict[str, Any]:
    """Return the JSON document of a summary."""
    outliers = [outlier for reasons in summary.outliers.values() for outlier in reasons]
    return {
        "schema": 1,
        "logs": len(summary.logs),
        "status": summary.status,
        "headline": summary.headline,
        "failed": summary.failed,
        "errors": summary.failures,
        "copies": summary.copies,
        "outliers": sorted(outliers, key=lambda outlier: (outlier.p, outlier.log)),
        "figures": {
            metric.column.name: {
                "unit": metric.column.unit,
                "count": metric.values.size,
                "median": metric.median,
                "scale": metric.scale,
                "quantiles": metric.quantiles,
                "outliers": int(metric.outlying.sum()),
            }
            for metric in summary.metrics
        },
    }
