"""The default limits of a car, and a file of them to edit, each with its reason and next step."""

from math import inf
from pathlib import Path
from typing import Any

from calib.base.errors import LimitsError
from calib.base.plain import METRICS
from calib.estimation.limits import DEFAULTS, Limit
from calib.estimation.limits_file import read_limits
from calib.estimation.metrics import METRICS as OF_STOPS
from calib.line.station.metrics import METRICS as OF_CAR


def _limit(key: str) -> Limit:
    metric = METRICS[key]
    of_station = metric.low, metric.high, metric.warn_low, metric.warn_high
    ends = metric.stop if of_station == (None,) * 4 else of_station
    return Limit(key, *ends, metric.required)


_JUDGED = (key for key, one in METRICS.items() if one.judged)
LIMITS = tuple(map(_limit, sorted(_JUDGED, key=lambda key: METRICS[key].judged)))
"""The default limits: first of the car, then of each stop."""


def limits_of_car(path: Path | None) -> tuple[Limit, ...]:
    """The limits of a file for a car and its stops; `LIMITS` without one. Raises LimitsError."""
    return read_limits(path, {*OF_STOPS, *OF_CAR}) if path else LIMITS


def limits_of_stops(path: Path | None) -> tuple[Limit, ...]:
    """The limits of a file for single stops; `DEFAULTS` without one. Raises LimitsError."""
    if path is None:
        return DEFAULTS
    limits = tuple(limit for limit in limits_of_car(path) if limit.figure in OF_STOPS)
    if not limits:
        do = "judge the car with `brake-cal station`"
        raise LimitsError("no limit for a stop", where=path, do=do)
    return limits


def document() -> list[dict[str, Any]]:
    """The limits with their units, reasons and next steps, as plain data."""
    rows = [(limit, METRICS[limit.figure]) for limit in LIMITS]
    return [
        {
            "limit": limit,
            "unit": one.unit if one.unit and one.factor == 1.0 else "1",
            "reason": one.reason,
            "action": one.action,
        }
        for limit, one in rows
    ]


_EXAMPLE = "torque_error_f = { max = 0.05 }"
_HEAD = """\
Limits for `brake-cal station --limits` and `brake-cal validate --limits`.

fail = [low, high]   outside it the car fails;   -inf or inf leaves an end open
warn = [low, high]   outside it, but inside fail, the car passes with a warning
required = true      a metric that the logs cannot give counts as failed, not as not known

A metric without a line is not judged. `validate` judges the metrics of the stops only."""


def limits_file() -> str:
    """The text: every metric that is judged by default, then the other ones, as comments."""
    lines = [f"# {line}".rstrip() for line in _HEAD.splitlines()] + ["schema = 1", "", "[limits]"]
    for limit, metric in ((limit, METRICS[limit.figure]) for limit in LIMITS):
        fail, warn = _range(limit.low, limit.high), _range(limit.warn_low, limit.warn_high)
        required = ", required = true" * limit.required
        lines += [
            f"# {'each stop: ' * (metric.scope == 'stop')}{metric.meaning}",
            f"# why: {metric.reason}",
            f"{limit.figure} = {{fail = {fail}, warn = {warn}{required}}}",
            "",
        ]
    lines.append(f"# Not judged unless a line is added, such as `{_EXAMPLE}`:")
    others = ((figure, metric) for figure, metric in METRICS.items() if not metric.judged)
    lines += [
        f"# {figure}: {metric.meaning}" for figure, metric in others if metric.scope == "stop"
    ]
    return "\n".join(lines) + "\n"


def _range(low: float | None, high: float | None) -> str:
    return f"[{-inf if low is None else low}, {inf if high is None else high}]"
