"""Engine drag: the closed throttle slows the driven front wheels."""

import numpy as np

from calib.physics.effects.effect import Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import Motion
from calib.physics.vehicle import Vehicle

SPEED = 20.0
"""Speed at which the torque is told [m/s]."""


def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """M = M_e (1 + g (v - 20 m/s)) at the front, zero at the rear [N m per axle].

    Friction and pumping of an engine grow with its speed; ``drag_growth`` is 0 where it is not
    given, as in older files. Valid for one gear. Negative while the engine or a torque converter
    still drives the car. A logged ``T_drive_f`` counts besides: the effect is what the log does not
    hold.
    """
    grown = 1.0 + parameters.get("drag_growth", 0.0) * (motion.v - SPEED)
    return parameters["drag_torque"] * grown, np.zeros_like(motion.v)


EFFECT = Effect(
    card=Card(
        name="engine_drag",
        cause="engine in gear with closed throttle, front-wheel drive",
        equation="M = M_e (1 + g (v - 20 m/s)) on the front axle; no effect at drag_torque = 0",
        source=(
            "Gillespie, Fundamentals of Vehicle Dynamics, ch. 2; growth: Heywood, Internal "
            "Combustion Engine Fundamentals, ch. 13"
        ),
        looks_like="a nearly constant deceleration, braked or not, with slip at the front only",
        parameters=(
            Parameter("drag_torque", "N*m", -500.0, 1500.0, 150.0, 100.0),
            Parameter("drag_growth", "s/m", -0.02, 0.05, 0.008, 0.006, default=0.0),
        ),
    ),
    axle_moment=axle_moment,
)
