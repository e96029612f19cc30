"""What is always identified: parameters that all logs share, and what each log has of its own.

Shared ones are normal about a middle, they or their logarithm, by a row of `base.csv`: bounds and
standard deviation are those of x, for a value of middle exp(x), or of middle + scale x. States of a
log are no effect of the car: pads, tyres on its road, a slope, a zero of a_x, heat of discs. They
are normal about what all logs share, by a row of `own.csv`, with the usual standard deviation, or
the other one where a kind is asked for.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.base.plain import rows
from calib.car.tyre import MagicFormula
from calib.car.vehicle import Vehicle

_ROWS, _OWN_ROWS = (rows(name, "calib.diagnosis.explanation") for name in ("base.csv", "own.csv"))

NAMES = tuple(row["name"] for row in _ROWS)
BASE = len(NAMES)  # number of base parameters, the first ones of every vector
PADS = [NAMES.index(name) for name in ("pad_friction_f", "pad_friction_r")]

LOW, HIGH, _SIGMA, _MIDDLE = (
    np.array([float(row[key]) for row in _ROWS]) for key in ("low", "high", "sigma", "middle")
)
"""Least and largest x (11,) of the base parameters, and their priors."""

_LOGARITHM = np.array([row["scale"] == "log" for row in _ROWS])
_SCALE = np.array([1.0 if row["scale"] == "log" else float(row["scale"]) for row in _ROWS])

FORM_AT = np.linspace(0.05, 1.0, 8)  # normalised forces at which tyres depart from their form [1]
_FORM = 0.06  # standard deviation of that departure [1]
FORM_LIMIT = 5.0 * _FORM
"""Largest departure [1], as far as tyres of any make go: without it, soft tyres whose slip departs
by all of it imitate a late brake by the lag of their wheels."""
_REACH = 0.25  # range of force over which it is alike [1]
_ALIKE = 0.7  # correlation of front and rear tyres
_NEAR = np.exp(-0.5 * ((FORM_AT[:, None] - FORM_AT) / _REACH) ** 2) + 0.01 * np.eye(FORM_AT.size)
FORM_PRIOR = np.linalg.inv(np.kron([[1.0, _ALIKE], [_ALIKE, 1.0]], _FORM**2 * _NEAR))
"""Precision (2 k, 2 k) of the departures of both axles: a Gaussian process over the force."""

OWN = tuple(row["name"] for row in _OWN_ROWS)  # names of the states of a log, in their order
KINDS = tuple(dict.fromkeys(row["kind"] for row in _OWN_ROWS))
UNITS = {row["name"]: row["unit"] for row in _OWN_ROWS}
FACTOR_ON = {row["name"]: row["factor_on"] for row in _OWN_ROWS if row["factor_on"]}
"""States that are logarithms of factors, with the base parameters that they multiply."""

_FACTORS = [OWN.index(name) for name in FACTOR_ON]

_OF_KIND = np.array([row["kind"] for row in _OWN_ROWS])
_ALIKE_OWN, _USUAL, _OTHER = (
    np.array([float(row[key]) for row in _OWN_ROWS]) for key in ("alike", "usual", "other")
)
SCATTERED = ("pads", "road")  # kinds in which logs usually differ a little
COURSES = ("slope", "zero")  # states whose changes of a log hang on its time alone
HEATS = ("front_heat", "rear_heat")
SLOPE, ZERO, FRONT_HEAT, REAR_HEAT = (OWN.index(name) for name in (*COURSES, *HEATS))


@dataclass(frozen=True)
class Base:
    """Parameters that are always re-identified: pad friction by axle [1], and the tyre of both.

    ``radius`` the factor on the rolling radii of the vehicle file [1], common to both axles;
    ``clock`` [s] by which the pressure is logged early, against all other channels; ``form`` (2, k)
    the share by which the slip of front and rear tyres departs from all that at `FORM_AT`.
    """

    pad_friction_f: float
    pad_friction_r: float
    tyre: MagicFormula
    radius: float = 1.0
    clock: float = 0.0
    form: Array = field(default_factory=lambda: np.zeros((2, FORM_AT.size)), compare=False)

    def of_log(self, random_effects: Array) -> Self:
        """Base of a log, by the factors of its ``random_effects`` (8,) on pads and tyres."""
        on = dict(zip(FACTOR_ON.values(), np.exp(random_effects[_FACTORS]).tolist(), strict=True))
        return replace(
            self,
            pad_friction_f=on["pad_friction_f"] * self.pad_friction_f,
            pad_friction_r=on["pad_friction_r"] * self.pad_friction_r,
            tyre=self.tyre.on_surface(on["stiffness"], on["peak"]),
        )


def base_of(vehicle: Vehicle, x: Array) -> Base:
    """Base parameters from the first ones (11,) of the vector."""
    numbers = np.where(_LOGARITHM, _MIDDLE * np.exp(x), _MIDDLE + _SCALE * x)
    values = dict(zip(NAMES, numbers.tolist(), strict=True))
    front = values.pop("pad_friction_f") * vehicle.front.pad_friction
    rear = values.pop("pad_friction_r") * vehicle.rear.pad_friction
    radius, clock = values.pop("radius"), values.pop("clock")
    return Base(front, rear, MagicFormula(**values), radius, clock)


def base_sigma(sample: float) -> Array:
    """Standard deviations (11,) of the priors on x, for logs of that sample time [s]."""
    by_clock = np.array(NAMES) == "clock"
    return np.where(by_clock, _SIGMA * sample / _SCALE, _SIGMA)


def sizes(kinds: Iterable[str], alike: Iterable[str] = ()) -> Array:
    """Standard deviations (8,) where logs differ in some ``kinds`` and are ``alike`` in others."""
    usual = np.where(np.isin(_OF_KIND, list(alike)), _ALIKE_OWN, _USUAL)
    return np.where(np.isin(_OF_KIND, list(kinds)), _OTHER, usual)
