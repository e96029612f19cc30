"""The order of the line: logs by name or by the values of a column."""

import re
from collections.abc import Sequence
from typing import Any


def line_order(values: Sequence[object]) -> list[int]:
    """Indices that sort ``values``, text in natural order; unknown values go to the end.

    >>> line_order(["car10", "car9", None, "car1"])
    [3, 1, 0, 2]
    """
    return sorted(range(len(values)), key=lambda i: (is_unknown(values[i]), _key(values[i])))


def is_unknown(value: object) -> bool:
    """Whether a value is None or NaN."""
    return value is None or value != value


def _key(value: object) -> Any:
    if is_unknown(value):
        return 0
    return natural(value) if isinstance(value, str) else value


def natural(text: str) -> list[tuple[int, int, str]]:
    """Sort key that puts ``log10`` after ``log9``."""
    parts = re.split(r"(\d+)", text)
    return [(1, int(p), "") if p.isdecimal() else (0, 0, p) for p in parts]
