"""What a log may have of its own: pads, tyres on its road, a slope, a zero of a_x, heat of discs.

No effect of the car, but a state of one log, normal about what all logs share. Its standard
deviation is the usual one of `own.csv`, or the other one where a kind is asked for.
"""

from collections.abc import Iterable

import numpy as np

from calib.base.arrays import Array
from calib.base.plain import rows

_ROWS = rows("own.csv", "calib.diagnosis.explanation")

FACTOR_ON = {row["name"]: row["factor_on"] for row in _ROWS if row["factor_on"]}
"""States that are logarithms of factors, with the base parameters that they multiply."""

OWN = tuple(row["name"] for row in _ROWS)  # names of the states of a log, in their order
KINDS = tuple(dict.fromkeys(row["kind"] for row in _ROWS))
UNITS = {row["name"]: row["unit"] for row in _ROWS}

_OF_KIND = np.array([row["kind"] for row in _ROWS])
_ALIKE, _USUAL, _OTHER = (
    np.array([float(row[key]) for row in _ROWS]) for key in ("alike", "usual", "other")
)
"""Standard deviations (8,) of the states, in their units; logarithms of factors."""

SCATTERED = ("pads", "road")  # kinds in which logs usually differ a little

COURSES = ("slope", "zero")  # states whose changes of a log hang on its time alone
HEATS = ("front_heat", "rear_heat")
SLOPE, ZERO, FRONT_HEAT, REAR_HEAT = (OWN.index(name) for name in (*COURSES, *HEATS))

GRADE, ZERO_OF_A_X = "road_grade", "accelerometer_bias"  # effects that a log may have of its own


def sizes(kinds: Iterable[str], alike: Iterable[str] = ()) -> Array:
    """Standard deviations (8,) where logs differ in some ``kinds`` and are ``alike`` in others."""
    usual = np.where(np.isin(_OF_KIND, list(alike)), _ALIKE, _USUAL)
    return np.where(np.isin(_OF_KIND, list(kinds)), _OTHER, usual)
