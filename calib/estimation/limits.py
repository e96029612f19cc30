"""Limits of metrics, and the judgement of metrics by them."""

from collections.abc import Mapping
from dataclasses import dataclass

from calib.base.plain import METRICS, MetricLimits
from calib.base.warning import PlausibilityWarning

PASSED, WARNING, FAILED, NOT_KNOWN = "passed", "warning", "failed", "not known"  # verdicts


@dataclass(frozen=True)
class Limit:
    """Allowed range of a metric; any end may be open (None)."""

    figure: str  # key of the metric
    low: float | None  # a value outside of low to high fails
    high: float | None
    warn_low: float | None = None  # a value outside of warn_low to warn_high warns
    warn_high: float | None = None
    required: bool = False  # whether an unknown value fails


@dataclass(frozen=True)
class Judgement(Limit):
    """A limit and the ``value`` of its metric, None where the log cannot give it."""

    value: float | None = None

    @property
    def verdict(self) -> str:
        """`PASSED`, `WARNING`, `FAILED` or `NOT_KNOWN`."""
        if self.value is None:
            return FAILED if self.required else NOT_KNOWN
        if not _within(self.value, self.low, self.high):
            return FAILED
        return PASSED if _within(self.value, self.warn_low, self.warn_high) else WARNING

    @property
    def outcome(self) -> dict[str, bool | None]:
        """`passed`, None where it is not known, and `warned`, as JSON documents have them."""
        passed = {FAILED: False, NOT_KNOWN: None}.get(self.verdict, True)
        return {"passed": passed, "warned": self.verdict == WARNING}

    def warning(self, log: str) -> PlausibilityWarning:
        """Return the warning of a value outside ``warn_low`` to ``warn_high``."""
        assert self.value is not None
        cause = f"a stop, a sensor or pads that are not as usual: {METRICS[self.figure].meaning}"
        do = "look at this stop with `brake-cal check` and `brake-cal plot`"
        ends = self.warn_low, self.warn_high
        return PlausibilityWarning(self.figure, log, self.value, ends, (cause,), do)


def _within(value: float, low: float | None, high: float | None) -> bool:
    return (low is None or value >= low) and (high is None or value <= high)


DEFAULTS: tuple[Limit, ...] = tuple(
    Limit(key, *metric.validate, metric.required)
    for key, metric in METRICS.items()
    if metric.validate != MetricLimits()  # the limits of a stop: low, high, warn_low, warn_high
)
"""Limits of a stop when the user gives none: they demand that an ECU answers, and that its
intervals hold the truth. How large errors and intervals may be is for the user to limit."""


def judge(limits: tuple[Limit, ...], figures: Mapping[str, float | None]) -> tuple[Judgement, ...]:
    """Return the limits in their order with the values of the metrics ``figures``."""
    return tuple(Judgement(**vars(limit), value=figures.get(limit.figure)) for limit in limits)
