"""The parameters that are always identified, and the ground of a log.

Pads and road may differ from one log to the next. That is a state of a log and no effect. The
`Base` holds the parameters of the reference logs; the `Ground` of any other log has the factors by
which its pads and its road differ from theirs.
"""

from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.physics.magic_formula import MagicFormula

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Base:
    """Parameters that are always re-identified [1]: pad friction by axle, and the tyre.

    ``stiffness``, ``peak``, ``shape``, ``load_exponent``, ``bend``, ``peak_exponent`` [1] and
    ``relaxation`` [m] as in `MagicFormula`; ``radius`` the factor on the rolling radii of the
    vehicle file, common to both axles; ``tyre_ratio`` the stiffness of the rear tyres over that of
    the front ones, 1 in every fit: pads and tyres of an axle cannot both be fitted
    (`calib.diagnosis.undecided.doubts`).
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
    tyre_ratio: float = 1.0

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
