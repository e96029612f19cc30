"""The limits of a car when the user gives none, and the file of them that can be edited.

Every limit has its reason and a next step, so that the operator knows what to do with the car.
"""

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

from calib.base.plain import METRICS, plain
from calib.estimation.limits import DEFAULTS, Limit

if TYPE_CHECKING:
    from tomlkit.items import InlineTable


@dataclass(frozen=True)
class Advice:
    """Default ``limit``, the ``reason`` for it, and the ``action`` where it is not held."""

    limit: Limit
    unit: str
    reason: str
    action: str


def _advice(key: str) -> Advice:
    one = METRICS[key]
    limit = Limit(key, one.low, one.high, one.warn_low, one.warn_high, one.required)
    if limit == Limit(key, None, None):  # one limit for a stop, whichever command judges it
        limit = next(limit for limit in DEFAULTS if limit.figure == key)
    unit = one.unit if one.unit and one.factor == 1.0 else "1"
    return Advice(limit, unit, one.reason, one.action)


_JUDGED = [key for key, one in METRICS.items() if one.judged]
ADVICE = tuple(_advice(key) for key in sorted(_JUDGED, key=lambda key: METRICS[key].judged))
"""One row for each metric that is judged by default: first of the car, then of each stop."""
LIMITS: tuple[Limit, ...] = tuple(row.limit for row in ADVICE)


def action(figure: str) -> str:
    """What to do where the metric ``figure`` fails, in one or two sentences."""
    return plain(figure).action or "Look at the log with brake-cal check and brake-cal plot."


EXAMPLE = "torque_error_f = { max = 0.05 }"
HEAD = """\
Limits for `brake-cal station --limits` and `brake-cal validate --limits`.

fail = [low, high]   outside it the car fails;   -inf or inf leaves an end open
warn = [low, high]   outside it, but inside fail, the car passes with a warning
required = true      a metric that the logs cannot give counts as failed, not as not known

A metric without a line is not judged. `validate` judges the metrics of the stops only."""


def limits_file() -> str:
    """The text: every metric that is judged by default, then the other ones, as comments."""
    import tomlkit

    limits = tomlkit.table()
    for row in ADVICE:
        figure = row.limit.figure
        one = METRICS[figure]
        limits.add(tomlkit.comment("each stop: " * (one.of == "stop") + one.meaning))
        limits.add(tomlkit.comment(f"why: {row.reason}"))
        limits.add(figure, _entry(row))
        limits.add(tomlkit.nl())
    limits.add(tomlkit.comment(f"Not judged unless a line is added, such as `{EXAMPLE}`:"))
    for figure, one in METRICS.items():
        if one.of == "stop" and not one.judged:
            limits.add(tomlkit.comment(f"{figure}: {one.meaning}"))
    document = tomlkit.document()
    for line in HEAD.splitlines():
        document.add(tomlkit.comment(line) if line else tomlkit.comment(""))
    document.add("schema", 1)
    document.add("limits", limits)
    return tomlkit.dumps(document)


def _entry(row: Advice) -> "InlineTable":
    import tomlkit

    limit = row.limit
    entry = tomlkit.inline_table()
    entry.add("fail", [_end(limit.low, -inf), _end(limit.high, inf)])
    entry.add("warn", [_end(limit.warn_low, -inf), _end(limit.warn_high, inf)])
    if limit.required:
        entry.add("required", True)
    return entry


def _end(value: float | None, without: float) -> float:
    return without if value is None else value
