"""A data set as one list: one row per point of a curve, one per scalar."""

from collections.abc import Iterator

from calib.exports.dataset import Curve, Dataset
from calib.statistics.intervals import Z95

COLUMNS = (
    "label", "axis", "x", "value", "unit", "lower", "upper", "count", "flag", "meaning",
)  # fmt: skip
"""``value`` [unit] of ``label`` at ``x`` on ``axis``; of a scalar, axis and x are None.

``lower``, ``upper`` 95 % band; ``count``, ``flag`` as in `calib.table.table`; None where there is
none.
"""

Row = tuple[str | float | None, ...]
"""Type of a cell of the `COLUMNS`."""


def rows(data: Dataset) -> Iterator[Row]:
    """Every number of ``data``, curves first."""
    for curve in data.curves:
        yield from _points(curve, data.axis(curve.axis).values.tolist())
    for s in data.scalars:
        half = None if s.sigma is None else Z95 * s.sigma
        lower, upper = (None, None) if half is None else (s.value - half, s.value + half)
        yield (s.label, None, None, s.value, s.unit, lower, upper, None, None, s.meaning)


def _points(c: Curve, x: list[float]) -> Iterator[Row]:
    columns = (x, c.values, c.lower, c.upper, c.count, c.flag)
    for at, value, *rest in zip(*(list(map(float, column)) for column in columns), strict=True):
        yield (c.label, c.axis, at, value, c.unit, *rest, c.meaning)
