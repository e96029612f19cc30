"""A value within its limits as a bar: where it may be, where a warning begins, where it is.

failed | warning |        passed        | warning | failed
░░░░░░░▒▒▒▒▒▒▒▒▒▒████████████▼███████████▒▒▒▒▒▒▒▒▒▒░░░░░░░░
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

ROOM = 0.3
"""Part of the bar beyond each limit, over the range within them."""


@dataclass(frozen=True)
class Bar:
    """Places in percent of the width, each zone as (start, width); ``label`` says it in words.

    ``marks``: places of the values; one beyond an end of the bar is at that end.
    """

    passed: tuple[float, float]
    warning: tuple[float, float]
    marks: tuple[float, ...]
    label: str


def bar(
    values: Sequence[float | None],
    fail: tuple[float | None, float | None],
    warn: tuple[float | None, float | None],
    label: str,
) -> Bar | None:
    """The bar of ``values`` with their limits (low, high), None for an open end.

    None without any limit, and without any value.
    """
    known = [v for v in values if v is not None and math.isfinite(v)]
    ends = [x for x in (*fail, *warn) if x is not None]
    if not ends or not known:
        return None
    low, high = _axis(known, fail, warn)

    def place(x: float | None, open_end: float) -> float:
        at = open_end if x is None else min(max(x, low), high)
        return round(100.0 * (at - low) / (high - low), 2)

    held = place(fail[0], low), place(fail[1], high)
    calm = (
        max(held[0], place(warn[0], low)),
        min(held[1], place(warn[1], high)),
    )
    return Bar(
        (calm[0], round(max(calm[1] - calm[0], 0.0), 2)),
        (held[0], round(max(held[1] - held[0], 0.0), 2)),
        tuple(place(v, low) for v in known),
        label,
    )


def _axis(
    known: list[float],
    fail: tuple[float | None, float | None],
    warn: tuple[float | None, float | None],
) -> tuple[float, float]:
    """Ends of the bar: all limits with room beyond them; zero, if only one side has a limit."""
    lows = [x for x in (fail[0], warn[0]) if x is not None]
    highs = [x for x in (fail[1], warn[1]) if x is not None]
    if lows and highs:
        low, high = min(lows), max(highs)
        room = ROOM * ((high - low) or 1.0)
        return low - room, high + room
    if highs:
        return min(0.0, *known), max(highs) * (1.0 + ROOM) if max(highs) > 0.0 else 1.0
    top = max(*lows, min(max(known), 2.0 * max(lows)))
    return min(0.0, *lows), top * (1.0 + 0.1) if top > 0.0 else 1.0
