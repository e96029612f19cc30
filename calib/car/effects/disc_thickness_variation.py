"""Disc thickness variation: front torque that pulses once a turn."""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import RunHistory


def wheels(parameters: Parameters, history: RunHistory) -> dict[str, Array]:
    """Factors 1 + a sin(angle + phase) [1] on the front brakes.

    ``side`` is 0 when both discs pulse in step, 1 when only the left one does, -1 the right one.
    The angle counts from the first sample, unless its origin was set by the ripple of the run
    (`calib.diagnose`).
    """
    turned = history.ripple(parameters["phase"])
    a, side = parameters["amplitude"], parameters["side"]
    left, right = min(1.0, 1.0 + side), min(1.0, 1.0 - side)
    return {"fl": 1.0 + a * left * turned, "fr": 1.0 + a * right * turned}


EFFECT = Effect(
    card=Card(
        name="disc_thickness_variation",
        cause="front discs whose thickness varies around the turn (judder)",
        equation="front T_b (1 + a sin(angle + phase)), 1 or 2 discs; no effect at amplitude = 0",
        source="Jacobsson, Aspects of Disc Brake Judder, Proc. IMechE D 217 (2003)",
        looks_like="a_x and front wheel speeds that pulse with the wheel's turn while braking",
        parameters=(
            Parameter("amplitude", "1", 0.0, 0.3, 0.03, 0.02),
            Parameter("phase", "rad", -np.pi, np.pi, 0.0, 0.5),
            Parameter("side", "1", -1.0, 1.0, 0.0, 0.8),
        ),
    ),
    wheels=wheels,
)
