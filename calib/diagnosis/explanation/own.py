"""What a log may have of its own: pads, tyres on its road, a slope, a zero of a_x, heat of discs.

No effect of the car, but a state of one log. Each is a normal distribution about what all logs
share; its standard deviation is one of three of `own.csv`. A search takes the usual one, and the
other one where a kind is asked for.
"""

from collections.abc import Iterable

import numpy as np

from calib.base.arrays import Array
from calib.base.plain import rows

_ROWS = rows("own.csv", "calib.diagnosis.explanation")

OWN = tuple(row["name"] for row in _ROWS)
"""Names of the states of a log, in their order."""

_ALIKE, _USUAL, _OTHER = (
    np.array([float(row[key]) for row in _ROWS]) for key in ("alike", "usual", "other")
)
"""Standard deviations (8,) of the states, in their units; logarithms of `FACTORS`."""

UNITS = {row["name"]: row["unit"] for row in _ROWS}

FACTORS = frozenset(row["name"] for row in _ROWS if row["kind"] in ("pads", "road"))
"""States that are logarithms of factors."""

KINDS = tuple(dict.fromkeys(row["kind"] for row in _ROWS))

PEAK, SLOPE, ZERO, FRONT_HEAT, REAR_HEAT = range(3, len(OWN))

GRADE, ZERO_OF_A_X = "road_grade", "accelerometer_bias"
"""Effects of a car that a log may have of its own."""

_OF_KIND = np.array([row["kind"] for row in _ROWS])

SCATTERED = ("pads", "road")
"""Kinds in which logs usually differ a little."""


def sizes(kinds: Iterable[str], alike: Iterable[str] = ()) -> Array:
    """Standard deviations (8,) where logs differ in some ``kinds`` and are ``alike`` in others."""
    usual = np.where(np.isin(_OF_KIND, list(alike)), _ALIKE, _USUAL)
    return np.where(np.isin(_OF_KIND, list(kinds)), _OTHER, usual)
