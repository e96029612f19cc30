"""Values of a metric beyond which a log is named: those that can be, and in words."""

import math
from collections.abc import Callable

from calib.line.fleet.rows import Command, columns_of

Range = tuple[float, float]

SIGNED = frozenset({
    "eta_zero", "pad_friction_bias_f", "pad_friction_bias_r", "final_error_f", "final_error_r",
    "innovation_colour",
})  # fmt: skip
"""Metrics of any sign; all others of the program are 0 or more."""

MOST = {
    "valid_share": 1.0,
    "covered_share": 1.0,
    "truth_in_interval": 1.0,
    "pad_ratio_nominal_weight": 1.0,
    "eta_peak_is_real": 1.0,
}
"""The largest value that a metric can have, where there is one."""

OTHERS = {"innovation_lag1": (-1.0, 1.0), "gap_closed": (-math.inf, 1.0)}

KNOWN = frozenset(
    column.name for command in Command for column in columns_of(command) if column.kind is float
)


def possible(name: str) -> Range:
    """Smallest and largest value that the metric ``name`` can have; any of a metric not known here.

    >>> possible("valid_share"), possible("eta_zero")
    ((0.0, 1.0), (-inf, inf))
    """
    if name in OTHERS:
        return OTHERS[name]
    signed = name in SIGNED or name not in KNOWN
    return (-math.inf if signed else 0.0), MOST.get(name, math.inf)


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
