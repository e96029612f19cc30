"""Limits of a validation: the allowed range of each metric.

A metric that a log cannot give (without truth, for example) is `not known`; where it is
``required`` it fails. The TOML file of them: `calib.estimation.limits_file`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from calib.base.plain import METRICS

PASSED, WARNING, FAILED, NOT_KNOWN = "passed", "warning", "failed", "not known"
"""Verdicts of a judgement."""


@dataclass(frozen=True)
class Limit:
    """Allowed range of a metric; any end may be open (None).

    Outside ``low`` to ``high`` it fails, outside ``warn_low`` to ``warn_high`` it warns. A
    ``required`` metric that is not known fails.
    """

    figure: str
    low: float | None
    high: float | None
    warn_low: float | None = None
    warn_high: float | None = None
    required: bool = False


@dataclass(frozen=True)
class Judgement(Limit):
    """A limit and the value: ``passed`` is None where the log cannot give the metric.

    ``warned``: it passed, but is outside ``warn_low`` to ``warn_high``.
    """

    value: float | None = None
    passed: bool | None = None
    warned: bool = False

    @property
    def verdict(self) -> str:
        """`passed`, `warning`, `failed` or `not known`."""
        if self.passed is None:
            return NOT_KNOWN
        return (WARNING if self.warned else PASSED) if self.passed else FAILED


DEFAULTS: tuple[Limit, ...] = tuple(
    Limit(key, *one.stop, one.required) for key, one in METRICS.items() if one.stop != (None,) * 4
)
"""Limits of a stop when the user gives none, in the order of `calib/base/metrics.csv`.

They ask of what is handed out, the metrics with ``ecu_``: is it there, does it agree with truth or
with the estimate with v by its own interval? How large an error or an interval may be is for the
user to say: pads that differ from those of the ramp are less well known, and are right.
"""


def judge(limits: tuple[Limit, ...], figures: Mapping[str, float | None]) -> tuple[Judgement, ...]:
    """Compare the metrics ``figures`` with the limits, in the order of the limits."""
    return tuple(_judged(limit, figures.get(limit.figure)) for limit in limits)


def _judged(limit: Limit, value: float | None) -> Judgement:
    if value is None:
        return Judgement(**vars(limit), passed=False if limit.required else None)
    passed = _within(value, limit.low, limit.high)
    warned = passed and not _within(value, limit.warn_low, limit.warn_high)
    return Judgement(**vars(limit), value=value, passed=passed, warned=warned)


def _within(value: float, low: float | None, high: float | None) -> bool:
    return (low is None or value >= low) and (high is None or value <= high)
