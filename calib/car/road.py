"""The tyre along the road: the surface under each axle at every sample."""

import numpy as np
from numpy.typing import NDArray

from calib.car.lag import integral
from calib.car.magic_formula import MagicFormula
from calib.car.model import Model

Array = NDArray[np.float64]

RELAXATION_LENGTH = 0.3
"""Length [m] over which a tyre changes to a new surface; 0.2 to 0.5 m for a passenger car."""


def tyres_along(model: Model, time: Array, v: Array) -> tuple[MagicFormula, MagicFormula]:
    """The tyre of the front and of the rear axle on the surface under it, at every sample."""
    if not model.surfaces:
        return model.tyre, model.tyre
    travelled = integral(time, v)
    front, rear = (
        _tyre_at(model, time, travelled, behind) for behind in (0.0, model.vehicle.wheelbase)
    )
    return front, rear


def _tyre_at(model: Model, time: Array, travelled: Array, behind: float) -> MagicFormula:
    """The tyre of an axle ``behind`` [m] the front one; it changes over `RELAXATION_LENGTH`."""
    starts, factors = [], [(1.0, 1.0)]
    for surface in model.surfaces:
        on_road = surface.unit == "m"
        starts.append(surface.start if on_road else np.interp(surface.start, time, travelled))
        factors.append((surface.stiffness, surface.peak))
    points = np.ravel([[start, start + RELAXATION_LENGTH] for start in starts])
    logs = np.repeat(np.log(factors), 2, axis=0)[1:-1]
    stiffness, peak = (np.exp(np.interp(travelled - behind, points, c)) for c in logs.T)
    return model.tyre.on_surface(stiffness, peak)
