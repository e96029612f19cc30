"""The parameters that are always identified, and the ground of a log.

Pads and road may differ from one log to the next. That is a state of a log and no effect. The
`Base` holds the parameters of the reference logs; the `Ground` of any other log has the factors by
which its pads and its road differ from theirs.
"""

from dataclasses import dataclass, field, fields, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.car.magic_formula import MagicFormula
from calib.car.vehicle import Vehicle

Array = NDArray[np.float64]

STIFFNESS, PEAK = 25.0, 0.95
"""Start of the fit for the tyre: slip stiffness and peak of a passenger car, both per load [1]."""

SHAPE, LOAD_EXPONENT, BEND, RELAXATION, PEAK_EXPONENT = 1.65, 0.03, 0.1, 0.2, 0.04
"""Middle of the priors on the tyre's form [1, m]: passenger cars on asphalt; `calib.fit`. The
bend of a brush is 0.55; relaxation lengths are 0.1 to 0.6 m; the peak falls by 0 to 10 % where the
load doubles. A fit begins here, within its bounds: from a bound it may not move."""

BASE_SIGMA = np.array([0.5, 0.5, 0.5, 0.35, 0.1, 0.04, 0.2, 0.2, 0.04, 0.01])
"""Standard deviations of the priors on the logarithms of pads, stiffness and peak: wide; on that of
the shape factor, on the load exponent, the bend, the relaxation length and the exponent of the
peak: the spread of passenger tyres; on that of the rolling radii over those of the file: tyres wear
by 2 % of their radius, and heat, load and pressure change it by 0.5 %."""

CLOCK = 0.25
"""Standard deviation of the pressure's clock against that of all other channels, in samples: a
logger reads one channel after the other."""

CLOCK_UNIT = 0.01
"""Unit of the clock in a vector [s]."""

BASE = BASE_SIGMA.size + 1
"""Number of base parameters, the first ones of every vector; the clock is the last."""

FORM_AT = np.linspace(0.05, 1.0, 8)
"""Normalised forces at which a departure of a tyre from its form is given [1]."""

_FORM, _REACH, _ALIKE = 0.06, 0.25, 0.7
"""Standard deviation of that departure [1], the range of force over which it is alike [1], and the
correlation of front and rear tyres."""


def form_covariance() -> Array:
    """Covariance (2 k, 2 k) of the departures of both axles: a Gaussian process over the force."""
    apart = (FORM_AT[:, None] - FORM_AT) / _REACH
    one = _FORM**2 * (np.exp(-0.5 * apart**2) + 0.01 * np.eye(FORM_AT.size))
    return np.kron(np.array([[1.0, _ALIKE], [_ALIKE, 1.0]]), one)


@dataclass(frozen=True)
class Base:
    """Parameters that are always re-identified [1]: pad friction by axle, and the tyre.

    ``stiffness``, ``peak``, ``shape``, ``load_exponent``, ``bend``, ``peak_exponent`` [1] and
    ``relaxation`` [m] as in `MagicFormula`; ``radius`` the factor on the rolling radii of the
    vehicle file, common to both axles; ``clock`` [s] by which the pressure is logged early;
    ``form`` (2, k) the share by which the slip of front and
    rear tyres departs from all that at `FORM_AT`, None where it does not.
    """

    pad_friction_f: float
    pad_friction_r: float
    stiffness: float
    peak: float
    shape: float = MagicFormula.shape
    load_exponent: float = MagicFormula.load_exponent
    bend: float = MagicFormula.bend
    relaxation: float = MagicFormula.relaxation
    peak_exponent: float = MagicFormula.peak_exponent
    radius: float = 1.0
    clock: float = 0.0
    form: Array | None = field(default=None, compare=False)

    @property
    def tyre(self) -> MagicFormula:
        """The tyre of both axles."""
        return MagicFormula(
            stiffness=self.stiffness,
            peak=self.peak,
            shape=self.shape,
            load_exponent=self.load_exponent,
            bend=self.bend,
            relaxation=self.relaxation,
            peak_exponent=self.peak_exponent,
        )


def base_of(vehicle: Vehicle, x: Array) -> Base:
    """Base parameters from the first ones of the vector; logarithms of the ratio to nominal."""
    return Base(
        pad_friction_f=vehicle.front.pad_friction * float(np.exp(x[0])),
        pad_friction_r=vehicle.rear.pad_friction * float(np.exp(x[1])),
        stiffness=STIFFNESS * float(np.exp(x[2])),
        peak=PEAK * float(np.exp(x[3])),
        shape=SHAPE * float(np.exp(x[4])),
        load_exponent=LOAD_EXPONENT + float(x[5]),
        bend=max(BEND + float(x[6]), 0.0),
        relaxation=max(RELAXATION + float(x[7]), 0.0),
        peak_exponent=PEAK_EXPONENT + float(x[8]),
        radius=float(np.exp(x[9])),
        clock=CLOCK_UNIT * float(x[10]),
    )


@dataclass(frozen=True)
class Ground:
    """Factors on the base parameters of the reference logs [1]: pads by axle, tyre on its road."""

    pad_friction_f: float = 1.0
    pad_friction_r: float = 1.0
    stiffness: float = 1.0
    peak: float = 1.0

    @classmethod
    def of(cls, logarithms: Array) -> Self:
        """From the logarithms of the factors (4,), in the order of the fields."""
        return cls(*(float(x) for x in np.exp(logarithms)))

    @property
    def logarithms(self) -> Array:
        """Logarithms of the factors (4,)."""
        return np.log([getattr(self, f.name) for f in fields(self)])

    def applied(self, base: Base) -> Base:
        """The base parameters on this ground."""
        if self == REFERENCE:
            return base
        changed = {f.name: getattr(base, f.name) * getattr(self, f.name) for f in fields(self)}
        return replace(base, **changed)


REFERENCE = Ground()
