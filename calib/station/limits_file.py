"""The documented limits file that `brake-cal limits init` writes, ready to be edited."""

from calib.station.advice import ADVICE, Advice
from calib.station.metrics import METRICS as OF_CAR
from calib.validation.limits import SCHEMA
from calib.validation.metrics import METRICS as OF_STOPS

HEAD = f"""\
# Limits for `brake-cal station --limits` and `brake-cal validate --limits`.
#
# fail = [low, high]   outside it the car fails;   -inf or inf leaves an end open
# warn = [low, high]   outside it, but inside fail, the car passes with a warning
# required = true      a figure that the logs cannot give counts as failed, not as not known
#
# A line taken out is not judged. `validate` judges the stops and leaves the car's figures alone.
schema = {SCHEMA}

[limits]
"""


def limits_file() -> str:
    """The text: every figure that is judged by default, then those that could be, as comments."""
    shown = [_entry(row) for row in ADVICE]
    judged = {row.limit.figure for row in ADVICE}
    rest = [f"# {name}: {what}" for name, what in OF_STOPS.items() if name not in judged]
    return (
        HEAD
        + "\n".join(shown)
        + "\n# Not judged unless a line is added, such as `torque_error_f = { max = 0.05 }`:\n"
        + "\n".join(rest)
        + "\n"
    )


def _entry(row: Advice) -> str:
    limit = row.limit
    what = OF_CAR.get(limit.figure) or f"each stop: {OF_STOPS[limit.figure]}"
    fail = f"fail = [{_end(limit.low, '-inf')}, {_end(limit.high, 'inf')}]"
    warn = f"warn = [{_end(limit.warn_low, '-inf')}, {_end(limit.warn_high, 'inf')}]"
    required = ", required = true" if limit.required else ""
    return f"# {what}\n# why: {row.reason}\n{limit.figure} = {{ {fail}, {warn}{required} }}\n"


def _end(value: float | None, without: str) -> str:
    return without if value is None else repr(value)
