"""Detect channels that are another column times a number: computed, not measured."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import LogError
from calib.base.units import UnknownUnit, si_of, spelling
from calib.logs.log import Log
from calib.logs.source import ColumnSource
from calib.run.limits import LIMITS

Array = NDArray[np.float64]

PRESSURES = ("p_mc", "p_fl", "p_fr", "p_rl", "p_rr")
"""The channels that are checked. The bus of some cars has the demanded brake torque and no
pressure, and some decoders divide this torque by a constant to get a pressure."""

COUNTS = ("1", "-")
"""Units of a bare number."""


@dataclass(frozen=True)
class ComputedChannel:
    """``channel`` is ``factor`` times the column ``source`` in ``unit``, a unit of ``quantity``."""

    channel: str
    source: str
    unit: str
    factor: float

    def __str__(self) -> str:
        return (
            f"{self.channel} in bar is {self.factor:.4g} times {self.source} [{self.unit}]: it was "
            "computed from that and is not a measured pressure: log the pressure itself"
        )


def factor_between(channel: Array, other: Array) -> float | None:
    """The factor with which ``other`` gives ``channel``, or None; both of shape (n,).

    >>> factor_between(np.array([0.0, 1.0, 3.0, 2.0]), np.array([0.0, 100.0, 300.0, 200.0]))
    0.01
    """
    extent = float(np.ptp(channel))
    if extent == 0.0 or not np.isfinite(other).all() or np.ptp(other) == 0.0:
        return None
    factor = float(channel @ other / (other @ other))
    alike = float(np.max(np.abs(channel - factor * other))) < LIMITS.computed_alike * extent
    return round(factor, 12) if alike else None


def computed_channels(log: Log, source: ColumnSource) -> tuple[ComputedChannel, ...]:
    """The pressures of a log that equal a column of another quantity times a number.

    ``source`` is the opened file of ``log``. Only columns of `is_other_quantity` count as sources.
    """
    return tuple(_copies(log, source))


def _copies(log: Log, source: ColumnSource) -> Iterator[ComputedChannel]:
    pressures = [name for name in PRESSURES if name in log]
    for index, column in enumerate(source.columns):
        if column.name not in log.ignored or not pressures or not is_other_quantity(column.unit):
            continue
        try:
            (values,) = source.read([index])
        except LogError:
            continue
        for name in pressures:
            if values.size == log[name].size:
                factor = factor_between(log[name] / 1e5, values)
                if factor is not None:
                    yield ComputedChannel(name, column.name, spelling(str(column.unit)), factor)


def is_other_quantity(unit: str | None) -> bool:
    """Whether a unit is that of a quantity of which a pressure can be computed.

    Not so a pressure: a logger may write one in two units. Neither a bare number: it may be the
    count of the converter that the pressure was scaled from.
    """
    try:
        return unit is not None and spelling(unit) not in COUNTS and si_of(unit) not in ("Pa", "s")
    except UnknownUnit:
        return False
