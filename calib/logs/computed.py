"""Pressures that are another column of the log times a number, and so were not measured.

The bus of some cars has the demanded brake torque and no pressure, and some decoders divide this
torque by a constant to get one.
"""

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import WHEEL_PRESSURES
from calib.base.units import UnknownUnit, from_si, si_of, spelling
from calib.base.warning import LIMITS
from calib.logs.log import ComputedPressure
from calib.logs.source import ColumnSource, Recording, each_of


def computed_pressures(
    channels: Mapping[str, Array], ignored: Collection[str], source: ColumnSource | Recording
) -> Iterator[ComputedPressure]:
    """Pressures among ``channels`` [SI] that are one of the ``ignored`` columns of a source.

    None of a recording: a bus has thousands of signals, which are not searched.
    """
    names = [name for name in ("p_mc", *WHEEL_PRESSURES) if name in channels]
    bar = {name: from_si(channels[name], "bar", "Pa") for name in names}
    if isinstance(source, Recording) or not bar:
        return
    others = [
        (index, column)
        for index, column in enumerate(source.columns)
        if column.name in ignored and is_other_quantity(column.unit)
    ]
    every = each_of(source.read, [index for index, _ in others])
    for (_, column), values in zip(others, every, strict=True):
        if isinstance(values, LogError):
            continue
        for channel, pressure in bar.items():
            factor = factor_between(pressure, values) if values.size == pressure.size else None
            if factor is not None:
                yield ComputedPressure(channel, factor, column.name, spelling(str(column.unit)))


def factor_between(channel: Array, other: Array) -> float | None:
    """The factor with which ``other`` gives ``channel``, or None; both of shape (n,)."""
    extent = float(np.ptp(channel))
    if extent == 0.0 or not np.isfinite(other).all() or np.ptp(other) == 0.0:
        return None
    factor = float(channel @ other / (other @ other))
    alike = float(np.max(np.abs(channel - factor * other))) < LIMITS.computed_alike * extent
    return round(factor, 12) if alike else None


def is_other_quantity(unit: str | None) -> bool:
    """Whether a unit is that of a quantity of which a pressure can be computed.

    Not a pressure, which may be logged in two units; nor a bare number, such as its raw count.
    """
    try:
        bare = unit is None or spelling(unit) in ("1", "-")
        return not bare and si_of(str(unit)) not in ("Pa", "s")
    except UnknownUnit:
        return False
