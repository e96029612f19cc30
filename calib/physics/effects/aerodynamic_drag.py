"""Aerodynamic drag: a force on the body that grows with the square of the speed."""

from calib.physics.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.physics.history import Motion
from calib.physics.vehicle import Vehicle

AIR_DENSITY = 1.2
"""Density of air at 20 degC and 1013 hPa [kg/m^3], ISO 2533 rounded."""


def body_force(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
    """F = 1/2 rho c_d A v^2 [N]; still air, standard density."""
    return 0.5 * AIR_DENSITY * parameters["drag_area"] * motion.v**2


EFFECT = Effect(
    card=Card(
        name="aerodynamic_drag",
        cause="air resistance of the body",
        equation="F = 1/2 rho (c_d A) v^2, rho = 1.2 kg/m^3; no effect at drag_area = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 4",
        looks_like="deceleration beyond the tyre forces that falls with v^2, braked or not",
        parameters=(Parameter("drag_area", "m^2", 0.0, 12.0, 0.65, 0.25),),
    ),
    body_force=body_force,
)
