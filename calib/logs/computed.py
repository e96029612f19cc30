"""Find pressures that were not measured, but computed as a constant times another column.

The bus of some cars carries the demanded brake torque and no pressure. Some decoders divide this
torque by a constant and call the result a pressure.
"""

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import WHEEL_PRESSURES
from calib.base.units import from_si, is_unit, si_of, spelling
from calib.base.warning import LIMITS
from calib.logs.log import ComputedPressure
from calib.logs.source import ColumnSource, Recording, read_each


def computed_pressures(
    channels: Mapping[str, Array], ignored: Collection[str], source: ColumnSource | Recording
) -> Iterator[ComputedPressure]:
    """Yield the pressures among ``channels`` [SI] that are a multiple of an ``ignored`` column.

    A recording yields none: a bus has thousands of signals, which are not searched.
    """
    names = [name for name in ("p_mc", *WHEEL_PRESSURES) if name in channels]
    if isinstance(source, Recording) or not names:
        return
    pressures = {name: from_si(channels[name], "bar", "Pa") for name in names}
    indices = [
        index
        for index, column in enumerate(source.columns)
        if column.name in ignored and may_be_source(column.unit)
    ]
    for index, values in zip(indices, read_each(source.read, indices), strict=True):
        if isinstance(values, LogError):
            continue
        column = source.columns[index]
        for channel, pressure in pressures.items():
            factor = factor_between(pressure, values) if values.size == pressure.size else None
            if factor is not None:
                yield ComputedPressure(channel, factor, column.name, spelling(str(column.unit)))


def factor_between(channel: Array, other: Array) -> float | None:
    """Return c of channel = c * other, both (n,), by least squares; None if a residual is large."""
    channel_range = float(np.ptp(channel))
    if channel_range == 0.0 or not np.isfinite(other).all() or np.ptp(other) == 0.0:
        return None
    factor = float(channel @ other / (other @ other))
    residual = float(np.max(np.abs(channel - factor * other)))
    return round(factor, 12) if residual < LIMITS.computed_alike * channel_range else None


def may_be_source(unit: str | None) -> bool:
    """Whether a pressure may have been computed from a column with this unit.

    Excluded are pressures, since one may be the same pressure in another unit; numbers without a
    unit, since one may be the raw count of the pressure; and times, which are no measured quantity.
    """
    if unit is None or spelling(unit) in ("1", "-") or not is_unit(unit):
        return False
    return si_of(unit) not in ("Pa", "s")
