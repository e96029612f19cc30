"""Judged metrics as a table: plain name, value, bar, limits, verdict; the worst first.

A value within its limits as a bar: where it may be, where a warning begins, where it is.

failed | warning |        passed        | warning | failed
░░░░░░░▒▒▒▒▒▒▒▒▒▒████████████▼███████████▒▒▒▒▒▒▒▒▒▒░░░░░░░░
"""

import math
from collections.abc import Mapping, Sequence

from calib.base.plain import counted, plain, plus_minus
from calib.estimation.limits import FAILED, NOT_KNOWN, PASSED, WARNING, Judgement
from calib.estimation.validate import CALIBRATION, Validation
from calib.show.facts import Bar, Table

_ROOM = 0.3
"""Part of the bar beyond each limit, over the range within them."""
_WORST_FIRST = (FAILED, WARNING, PASSED, NOT_KNOWN)
_HEADS = ("metric", "value", "limit", "no warning", "verdict", "key")
_Ends = tuple[float | None, float | None]
"""Low and high, None for an open end."""


def judged(caption: str, groups: Sequence[Sequence[Judgement]]) -> tuple[Table, list[str]]:
    """One row for each metric, judged once or stop by stop, and a note on what is not known."""
    rows, bars, unknown = [], [], []
    for group in sorted(groups, key=lambda group: _WORST_FIRST.index(_worst(group))):
        first, shown = group[0], plain(group[0].figure)
        if _worst(group) == NOT_KNOWN:
            unknown.append(shown.name)
            continue
        values = [shown.value(j.value) for j in group]
        unit = f" {shown.unit}" if shown.unit else ""
        alike = len({*values}) == 1
        text = shown.with_unit(first.value) if alike else ", ".join(values) + unit
        fail, warn = (first.low, first.high), (first.warn_low, first.warn_high)
        limits = [shown.bounds(*ends) for ends in (fail, warn)]
        told = ["" if limit == "none" else limit for limit in limits]
        rows.append((shown.name, text, *told, _worst(group), first.figure))
        bars.append(bar([j.value for j in group], fail, warn, f"{text}; limit {limits[0]}"))
    table = Table(_HEADS, rows, caption, [row[4] for row in rows], bars)
    return table, [f"Not known and so not judged: {', '.join(unknown)}."] * bool(unknown)


def word(r: Validation) -> str:
    """The verdict on one log in a word or two."""
    if r.role == CALIBRATION:
        return "no hold-out"
    count = len(r.all_warnings)
    return f"{r.verdict}, {counted(count, 'warning')}" if count else r.verdict


def pads(figures: Mapping[str, float | None], axle: str) -> str | None:
    """Mean pad friction of a stop on ``axle`` f or r with its 95 % interval; None without any."""
    mean, width = figures[f"pad_friction_{axle}"], figures[f"interval_{axle}"]
    return None if mean is None or width is None else plus_minus(mean, mean * width)


def broken(r: Validation) -> list[str]:
    """Name and value of each metric that breaks its limit, and the limit."""
    return [
        f"{shown.name} ({j.figure}) is {shown.with_unit(j.value)}, {shown.bounds(j.low, j.high)}"
        for j in r.judgements
        if j.passed is False and (shown := plain(j.figure))
    ]


def _worst(group: Sequence[Judgement]) -> str:
    """The verdict on all of them; what is known of one stop hides that another has no value."""
    return min((j.verdict for j in group), key=_WORST_FIRST.index)


def bar(values: Sequence[float | None], fail: _Ends, warn: _Ends, label: str) -> Bar | None:
    """The bar of ``values`` with their limits; None without any limit, and without any value."""
    known = [v for v in values if v is not None and math.isfinite(v)]
    if not known or (*fail, *warn) == (None,) * 4:
        return None
    low, high = _axis(known, fail, warn)

    def place(x: float | None, open_end: float) -> float:
        at = open_end if x is None else min(max(x, low), high)
        return round(100.0 * (at - low) / (high - low), 2)

    held = place(fail[0], low), place(fail[1], high)
    calm = max(held[0], place(warn[0], low)), min(held[1], place(warn[1], high))
    zones = [(start, round(max(end - start, 0.0), 2)) for start, end in (calm, held)]
    return Bar(zones[0], zones[1], tuple(place(v, low) for v in known), label)


def _axis(known: list[float], fail: _Ends, warn: _Ends) -> tuple[float, float]:
    """Ends of the bar: all limits with room beyond them; zero, if only one side has a limit."""
    lows = [x for x in (fail[0], warn[0]) if x is not None]
    highs = [x for x in (fail[1], warn[1]) if x is not None]
    if lows and highs:
        low, high = min(lows), max(highs)
        room = _ROOM * ((high - low) or 1.0)
        return low - room, high + room
    if highs:
        return min(0.0, *known), max(highs) * (1.0 + _ROOM) if max(highs) > 0.0 else 1.0
    top = max(*lows, min(max(known), 2.0 * max(lows)))
    return min(0.0, *lows), top * 1.1 if top > 0.0 else 1.0
