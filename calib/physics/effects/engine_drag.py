"""Engine drag: the closed throttle slows the driven front wheels."""

import numpy as np

from calib.physics.effects.effect import Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import Motion
from calib.physics.vehicle import Vehicle


def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """M = M_e at the front, zero at the rear [N m per axle].

    Constant: valid for one gear and engine friction that does not depend on speed. Negative while
    the engine or a torque converter still drives the car. A logged ``T_drive_f`` counts besides:
    the effect is what the log does not hold.
    """
    return np.full_like(motion.v, parameters["drag_torque"]), np.zeros_like(motion.v)


EFFECT = Effect(
    card=Card(
        name="engine_drag",
        cause="engine in gear with closed throttle, front-wheel drive",
        equation="M = M_e on the front axle; no effect at drag_torque = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 2",
        looks_like="a constant deceleration, braked or not, with slip at the front only",
        parameters=(Parameter("drag_torque", "N*m", -500.0, 1500.0, 150.0, 100.0),),
    ),
    axle_moment=axle_moment,
)
