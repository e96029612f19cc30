"""Disc thickness variation: front torque that pulses once a turn."""

import numpy as np

from calib.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters, Trace


def friction(parameters: Parameters, trace: Trace, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 + a sin(angle + phase) [1] on the front, 1 on the rear; left and right in step.

    The angle counts from the first sample, so the phase belongs to one run.
    """
    turned = np.sin(trace.angle_f + parameters["phase"])
    return 1.0 + parameters["amplitude"] * turned, np.ones_like(p_r)


EFFECT = Effect(
    card=Card(
        name="disc_thickness_variation",
        cause="front discs whose thickness varies around the turn (judder)",
        equation="T_bf (1 + a sin(angle + phase)); nothing at amplitude = 0",
        source="Jacobsson, Aspects of Disc Brake Judder, Proc. IMechE D 217 (2003)",
        looks_like="a_x and front wheel speeds that pulse with the wheel's turn while braking",
        parameters=(
            Parameter("amplitude", "1", 0.0, 0.3, 0.03, 0.02),
            Parameter("phase", "rad", -np.pi, np.pi, 0.0, 1.8),
        ),
    ),
    friction=friction,
)
