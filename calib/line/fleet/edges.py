"""Values of a metric beyond which a log is named: those that can be, and in words."""

import math
from collections.abc import Callable

from calib.base.plain import plain

Range = tuple[float, float]


def possible(name: str) -> Range:
    """Smallest and largest value that the metric ``name`` can have; any of a metric not known here.

    >>> possible("valid_share"), possible("eta_zero")
    ((0.0, 1.0), (-inf, inf))
    """
    one = plain(name)
    return (
        -math.inf if one.least is None else one.least,
        math.inf if one.most is None else one.most,
    )


def within(edges: Range, possible: Range) -> Range:
    """Edges, infinite where no value of the metric can be beyond them.

    >>> within((-0.01, 8.0), (0.0, math.inf))
    (-inf, 8.0)
    """
    low, high = edges
    return (low if low > possible[0] else -math.inf), (high if high < possible[1] else math.inf)


def in_words(edges: Range, shown: Callable[[float], str]) -> str:
    """Edges as `below 0.31 or above 0.45`; empty if none is finite.

    >>> in_words((-math.inf, 8.0), str)
    'above 8.0'
    """
    told = (("below", edges[0]), ("above", edges[1]))
    return " or ".join(f"{side} {shown(edge)}" for side, edge in told if math.isfinite(edge))
