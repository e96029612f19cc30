"""What the estimator says of one axle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class AxleEstimate:
    """One axle: pad friction mu with 95 % interval [1], brake torque of one wheel [N m], (n,).

    ``normalised_force`` F_x/F_z [1] over the quasi-static load (6), (7). Nominal, with a wide
    interval, before the pads first bite. ``change`` mu over that of the calibration [1] with its
    own interval: sharper, since tyres and radii are those of the ramp.
    """

    pad_friction: Array
    lower: Array
    upper: Array
    torque: Array
    normalised_force: Array
    change: Array
    change_lower: Array
    change_upper: Array

    @property
    def half_width(self) -> Array:
        """Half the width of the 95 % interval of the logarithm of pad friction (n,) [1]."""
        return np.asarray(0.5 * np.log(self.upper / self.lower))
