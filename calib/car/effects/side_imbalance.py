"""Side imbalance: the torques of the left and the right brakes differ."""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import RunHistory


def wheels(parameters: Parameters, history: RunHistory) -> dict[str, Array]:
    """Factors 1 + x and 1 - x [1] on the brake torques, left and right; r x on the rear.

    The driver keeps the car straight; side forces are neglected.
    """
    one, x = np.ones_like(history.time), parameters["imbalance"]
    y = parameters["rear_share"] * x
    left_right = {"fl": 1.0 + x, "fr": 1.0 - x, "rl": 1.0 + y, "rr": 1.0 - y}
    if y == 0.0:  # both rear wheels are equal: only one of them is computed
        del left_right["rl"], left_right["rr"]
    return {wheel: factor * one for wheel, factor in left_right.items()}


EFFECT = Effect(
    card=Card(
        name="side_imbalance",
        cause="pads, pistons or discs that differ between left and right",
        equation="front T_b (1 +- x), rear T_b (1 +- r x), left +; no effect at imbalance = 0",
        source="Limpert, Brake Design and Safety, ch. 7; UN R13-H, annex 3",
        looks_like="left and right slips differ in proportion to torque, only while braked",
        parameters=(
            Parameter("imbalance", "1", -0.5, 0.5, 0.08, 0.05),
            Parameter("rear_share", "1", -0.2, 1.2, 0.5, 0.5),
        ),
    ),
    wheels=wheels,
)
