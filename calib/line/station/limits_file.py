"""The documented limits file that `brake-cal limits` writes, ready to be edited."""

from math import inf
from typing import TYPE_CHECKING

from calib.estimation.metrics import METRICS as OF_STOPS
from calib.line.station.advice import ADVICE, Advice
from calib.line.station.metrics import METRICS as OF_CAR

if TYPE_CHECKING:
    from tomlkit.items import InlineTable

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

    judged = {row.limit.figure for row in ADVICE}
    limits = tomlkit.table()
    for row in ADVICE:
        figure = row.limit.figure
        limits.add(tomlkit.comment(OF_CAR.get(figure) or f"each stop: {OF_STOPS[figure]}"))
        limits.add(tomlkit.comment(f"why: {row.reason}"))
        limits.add(figure, _entry(row))
        limits.add(tomlkit.nl())
    limits.add(tomlkit.comment(f"Not judged unless a line is added, such as `{EXAMPLE}`:"))
    for figure, what in OF_STOPS.items():
        if figure not in judged:
            limits.add(tomlkit.comment(f"{figure}: {what}"))
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
