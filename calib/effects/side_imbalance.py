"""Side imbalance: the left front brake does more than the right one, or less."""

import numpy as np

from calib.effects.effect import Array, Card, Effect, Parameter, Parameters, Trace


def wheels(parameters: Parameters, trace: Trace) -> dict[str, Array]:
    """Factors 1 + x and 1 - x [1] on the torques of the front brakes, left and right.

    The car is held straight by the driver; side forces are not looked at.
    """
    one, x = np.ones_like(trace.time), parameters["imbalance"]
    return {"fl": (1.0 + x) * one, "fr": (1.0 - x) * one}


EFFECT = Effect(
    card=Card(
        name="side_imbalance",
        cause="pads, pistons or discs that differ between left and right",
        equation="T_b,fl (1 + x), T_b,fr (1 - x); nothing at imbalance = 0",
        source="Limpert, Brake Design and Safety, ch. 7; UN R13-H, annex 3",
        looks_like="front wheels that differ in slip, with the brake only, in proportion to torque",
        parameters=(Parameter("imbalance", "1", -0.5, 0.5, 0.08, 0.05),),
    ),
    wheels=wheels,
)
