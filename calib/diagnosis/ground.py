"""What a log was driven on and with: pads and road may differ from one log to the next.

That is a state of a log and no effect. Parameters of the base stay those of the reference logs;
the `Ground` of any other log holds the factors by which its pads and its road differ from theirs.
"""

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from calib.diagnosis.predict import Base

Array = NDArray[np.float64]


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

    def applied(self, base: "Base") -> "Base":
        """The base parameters on this ground."""
        if self == REFERENCE:
            return base
        changed = {f.name: getattr(base, f.name) * getattr(self, f.name) for f in fields(self)}
        return replace(base, **changed)


REFERENCE = Ground()
