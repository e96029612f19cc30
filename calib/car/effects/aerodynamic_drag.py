"""Aerodynamic drag: a force on the body that grows with the square of the speed.

    F at the height of the road               load_share = 1: (6) and (7) at the whole deceleration
    F at that of the centre of gravity        load_share = 0: only the tyre forces move load

Where F acts, and the lift that comes with it, differ from car to car; a share below 0 or above 1 is
lift at one axle.
"""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import Motion, RunHistory
from calib.car.vehicle import Vehicle

AIR_DENSITY = 1.2
"""Density of air at 20 degC and 1013 hPa [kg/m^3], ISO 2533 rounded."""


ALL = 1.0
"""Share of the drag that moves load where none is given: the paper's (6) and (7)."""


def body_force(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
    """F = 1/2 rho c_d A v^2 [N]; still air, standard density."""
    return _drag(parameters, motion.v)


def load_shift(vehicle: Vehicle, parameters: Parameters, history: RunHistory) -> Array:
    """(1 - s) F h/(W L) [1]: what (6) has too much if F does not act at the road."""
    less = 1.0 - parameters.get("load_share", ALL)
    lever = vehicle.cg_height / (vehicle.weight * vehicle.wheelbase)
    return less * lever * _drag(parameters, history.v)


def _drag(parameters: Parameters, v: Array) -> Array:
    return np.asarray(0.5 * AIR_DENSITY * parameters["drag_area"] * v**2)


EFFECT = Effect(
    card=Card(
        name="aerodynamic_drag",
        cause="air resistance of the body",
        equation=(
            "F = 1/2 rho (c_d A) v^2, rho = 1.2 kg/m^3; front load less (1 - s) F h/L; no effect "
            "at drag_area = 0"
        ),
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 1 and 4",
        looks_like="deceleration beyond the tyre forces that falls with v^2, braked or not",
        parameters=(
            Parameter("drag_area", "m^2", 0.0, 12.0, 0.65, 0.25),
            Parameter("load_share", "1", -0.5, 1.5, 0.5, 0.25, default=ALL),
        ),
    ),
    load_shift=load_shift,
    body_force=body_force,
)
