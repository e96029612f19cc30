"""An effect of one's own: a flap at the rear that rises while the car brakes.

See calib/manual/vehicle_file.md. Everything is in SI.
"""

import numpy as np

from calib.car.effects.effect import Card, Effect, Parameter

AIR = 1.2  # density [kg/m^3]
OPENS = 5e5  # master cylinder pressure at which the flap is half up [Pa]


def body_force(vehicle, parameters, motion):
    """Force on the body [N], shape of motion.v, positive when it slows."""
    up = 0.5 * (1.0 + np.tanh((motion.history.p_mc - OPENS) / 1e5))
    return 0.5 * AIR * parameters["flap_area"] * motion.v**2 * up


EFFECT = Effect(
    card=Card(
        name="air_brake_flap",
        cause="a flap at the rear that rises while the car brakes",
        equation="F = 0.5 rho A v^2 while p_mc is above 5 bar; no effect at flap_area = 0",
        source="drawing of the flap",
        looks_like="more deceleration at high speed than the brakes give, and none in a coast",
        parameters=(Parameter("flap_area", "m^2", low=0.0, high=1.5, typical=0.6, spread=0.3),),
    ),
    body_force=body_force,
)
