"""The default limits of a car and its stops, and a limits file to edit, which explains each."""

from math import inf
from pathlib import Path
from typing import Any

from calib.base.errors import LimitsError
from calib.base.plain import METRICS, MetricLimits
from calib.estimation.limits import DEFAULTS, Limit
from calib.estimation.limits_file import read_limits
from calib.estimation.metrics import METRICS as OF_STOPS
from calib.line.station.metrics import METRICS as OF_CAR


def _limit(figure: str) -> Limit:
    """Return the default limit of a metric: that of the station, or else that of `validate`."""
    metric = METRICS[figure]
    ends = metric.station if metric.station != MetricLimits() else metric.validate
    return Limit(figure, *ends, metric.required)


_JUDGED = [figure for figure, metric in METRICS.items() if metric.judged]
LIMITS = tuple(_limit(figure) for figure in sorted(_JUDGED, key=lambda x: METRICS[x].judged))
"""The default limits, first of the car, then of each stop."""


def limits_of_car(path: Path | None) -> tuple[Limit, ...]:
    """Return the limits of a file for car and stops, or else `LIMITS`. Raises LimitsError."""
    return read_limits(path, {*OF_STOPS, *OF_CAR}) if path else LIMITS


def limits_of_stops(path: Path | None) -> tuple[Limit, ...]:
    """Return the limits of a file for single stops, or else `DEFAULTS`. Raises LimitsError."""
    if path is None:
        return DEFAULTS
    limits = tuple(limit for limit in limits_of_car(path) if limit.figure in OF_STOPS)
    if not limits:
        do = "judge the car with `brake-cal station`"
        raise LimitsError("no limit for a stop", where=path, do=do)
    return limits


def document() -> list[dict[str, Any]]:
    """Return the default limits with their units, reasons and next steps, as plain data."""
    rows = []
    for limit in LIMITS:
        metric = METRICS[limit.figure]
        # a metric with a factor, such as 100 for a percentage, has its limits as a share
        unit = metric.unit if metric.unit and metric.factor == 1.0 else "1"
        texts = {"unit": unit, "reason": metric.reason, "action": metric.action}
        rows.append({"limit": limit, **texts})
    return rows


_HEAD = """\
Limits for `brake-cal station --limits` and `brake-cal validate --limits`.

fail = [low, high]   outside it the car fails;   -inf or inf leaves an end open
warn = [low, high]   outside it, but inside fail, the car passes with a warning
required = true      a metric that the logs cannot give counts as failed, not as not known

A metric without a line is not judged. `validate` judges the metrics of the stops only."""


def limits_file() -> str:
    """Return the text of a limits file: the default limits, and metrics that have none."""
    lines = [f"# {line}".rstrip() for line in _HEAD.splitlines()] + ["schema = 1", "", "[limits]"]
    for limit in LIMITS:
        metric = METRICS[limit.figure]
        scope = "each stop: " if metric.scope == "stop" else ""
        fail, warn = _range(limit.low, limit.high), _range(limit.warn_low, limit.warn_high)
        required = ", required = true" if limit.required else ""
        lines += [f"# {scope}{metric.meaning}", f"# why: {metric.reason}"]
        lines += [f"{limit.figure} = {{fail = {fail}, warn = {warn}{required}}}", ""]
    lines.append("# Not judged unless a line is added, such as `torque_error_f = { max = 0.05 }`:")
    for figure, metric in METRICS.items():
        if metric.scope == "stop" and not metric.judged:
            lines.append(f"# {figure}: {metric.meaning}")
    return "\n".join(lines) + "\n"


def _range(low: float | None, high: float | None) -> str:
    return f"[{-inf if low is None else low}, {inf if high is None else high}]"
