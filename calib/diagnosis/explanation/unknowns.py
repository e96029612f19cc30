"""Unknowns of every diagnosis: base parameters that all logs share, and random effects of a log.

Base parameters describe pads, tyres, radius and clock of the car: the rows of `base.csv`. The value
of each is middle exp(x) or middle + scale x. Its x is normal about zero; the row has the standard
deviation and the bounds of x, but for the clock the standard deviation of the value in samples.

Random effects are states in which the logs of a car differ: pads, tyres on the road of the log, a
slope, a zero of a_x, heat of the discs. Each is normal about zero and belongs to a group. Its
standard deviations are columns of `random_effects.csv`: `other` if a hypothesis says that logs
differ in that group, `alike` if it says that they do not, else `usual`.

The shape discrepancy of a tyre (after Kennedy and O'Hagan) is the share by which its slip departs
from that of its formula, a function of the normalised force.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.base.plain import rows
from calib.car.tyre import MagicFormula
from calib.car.vehicle import Vehicle

_ROWS = rows("base.csv", "calib.diagnosis.explanation")
_RANDOM_ROWS = rows("random_effects.csv", "calib.diagnosis.explanation")

BASE_NAMES = tuple(row["name"] for row in _ROWS)
BASE_SIZE = len(BASE_NAMES)  # base parameters are the first elements of every vector x
PADS = [BASE_NAMES.index(name) for name in ("pad_friction_f", "pad_friction_r")]

LOW, HIGH, _SIGMA, _MIDDLE = (
    np.array([float(row[key]) for row in _ROWS]) for key in ("low", "high", "sigma", "middle")
)
"""By base parameter (11,): bounds and standard deviation of x, and middle of the value."""
_LOGARITHM = np.array([row["scale"] == "log" for row in _ROWS])
_SCALE = np.array([1.0 if row["scale"] == "log" else float(row["scale"]) for row in _ROWS])

DISCREPANCY_FORCES = np.linspace(0.05, 1.0, 8)  # normalised forces of the discrepancy's values [1]
_DISCREPANCY = 0.06  # standard deviation of the discrepancy [1]
DISCREPANCY_LIMIT = 5.0 * _DISCREPANCY
"""Largest discrepancy [1], about the largest of any tyre. Without a limit, tyres with far too much
slip, whose wheels lag, could explain a brake that acts late."""
_REACH = 0.25  # difference of force over which the discrepancy is correlated [1]
_CORRELATION_OF_AXLES = 0.7  # of the discrepancies of front and rear tyres [1]

_DISTANCES = DISCREPANCY_FORCES[:, None] - DISCREPANCY_FORCES  # (k, k)
# correlations of the forces, with a small uncorrelated part, and of the axles
_BY_FORCE = np.exp(-0.5 * (_DISTANCES / _REACH) ** 2) + 0.01 * np.eye(DISCREPANCY_FORCES.size)
_BY_AXLE = [[1.0, _CORRELATION_OF_AXLES], [_CORRELATION_OF_AXLES, 1.0]]
DISCREPANCY_PRECISION = np.asarray(np.linalg.inv(np.kron(_BY_AXLE, _DISCREPANCY**2 * _BY_FORCE)))
"""Precision (2 k, 2 k) of the discrepancies of both axles: a Gaussian process of the force."""

RANDOM_EFFECTS = tuple(row["name"] for row in _RANDOM_ROWS)
GROUPS = tuple(dict.fromkeys(row["group"] for row in _RANDOM_ROWS))
_FACTOR_ON = {row["name"]: row["factor_on"] for row in _RANDOM_ROWS if row["factor_on"]}
FACTORS = [RANDOM_EFFECTS.index(name) for name in _FACTOR_ON]
"""Places of the random effects that are the logarithm of a factor on a base parameter."""
MULTIPLIED = [BASE_NAMES.index(name) for name in _FACTOR_ON.values()]
"""Places of these base parameters, in the same order."""
_GROUP_OF = np.array([row["group"] for row in _RANDOM_ROWS])
_ALIKE_SIGMA, _USUAL_SIGMA, _OTHER_SIGMA = (
    np.array([float(row[key]) for row in _RANDOM_ROWS]) for key in ("alike", "usual", "other")
)
SCATTERED = ("pads", "road")  # groups in which logs usually differ a little
NO_FACTORS = [place for place in range(len(RANDOM_EFFECTS)) if place not in FACTORS]
SLOPE, ZERO, FRONT_HEAT, REAR_HEAT = NO_FACTORS  # in the order of the file


@dataclass(frozen=True)
class Base:
    """Values of the base parameters, and the tyre discrepancies."""

    pad_friction_f: float  # [1]
    pad_friction_r: float
    tyre: MagicFormula  # of both axles
    radius: float = 1.0  # factor on all rolling radii of the vehicle file [1]
    clock: float = 0.0  # time by which the pressure is logged before all other channels [s]
    discrepancy: Array = field(
        default_factory=lambda: np.zeros((2, DISCREPANCY_FORCES.size)), compare=False
    )
    """By axle and force of `DISCREPANCY_FORCES` [1]."""

    def of_log(self, random_effects: Array) -> Self:
        """Return the base of a log, whose ``random_effects`` (8,) change pads and tyres."""
        factors = np.exp(random_effects[FACTORS]).tolist()
        factor = dict(zip(_FACTOR_ON.values(), factors, strict=True))
        return replace(
            self,
            pad_friction_f=factor["pad_friction_f"] * self.pad_friction_f,
            pad_friction_r=factor["pad_friction_r"] * self.pad_friction_r,
            tyre=self.tyre.on_surface(factor["stiffness"], factor["peak"]),
        )


def base_of(vehicle: Vehicle, x: Array) -> Base:
    """Return the base parameters at ``x`` (11,)."""
    numbers = np.where(_LOGARITHM, _MIDDLE * np.exp(x), _MIDDLE + _SCALE * x)
    values = dict(zip(BASE_NAMES, numbers.tolist(), strict=True))
    front = values.pop("pad_friction_f") * vehicle.front.pad_friction
    rear = values.pop("pad_friction_r") * vehicle.rear.pad_friction
    radius, clock = values.pop("radius"), values.pop("clock")
    return Base(front, rear, MagicFormula(**values), radius, clock)


def base_sigma(sample_time: float) -> Array:
    """Standard deviations (11,) of the priors on x, for logs of this ``sample_time`` [s]."""
    is_clock = np.array(BASE_NAMES) == "clock"  # the file has its standard deviation in samples
    return np.where(is_clock, _SIGMA * sample_time / _SCALE, _SIGMA)


def random_sigmas(groups: Iterable[str], alike: Iterable[str] = ()) -> Array:
    """Standard deviations (8,) of the random effects.

    Logs differ in ``groups``, are the same in other groups ``alike``, and else differ as usual.
    """
    sigmas = np.where(np.isin(_GROUP_OF, list(alike)), _ALIKE_SIGMA, _USUAL_SIGMA)
    return np.where(np.isin(_GROUP_OF, list(groups)), _OTHER_SIGMA, sigmas)
