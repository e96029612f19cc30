"""Pressure dependence of the pads: friction that changes with the clamping pressure."""

from calib.physics.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import RunHistory

REFERENCE_PRESSURE = 20e5
"""Pressure [Pa] at which the pad friction is that of the model; the middle of usual braking."""


def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 + k (p - 20 bar) [1], p of the caliper; a straight line, wrong far from 20 bar."""
    slope = parameters["pressure_slope"]
    return 1.0 + slope * (p_f - REFERENCE_PRESSURE), 1.0 + slope * (p_r - REFERENCE_PRESSURE)


EFFECT = Effect(
    card=Card(
        name="pad_pressure_dependence",
        cause="pad friction changes with the contact pressure",
        equation="mu_p (1 + k (p - 20 bar)); no effect at pressure_slope = 0",
        source="Limpert, Brake Design and Safety, ch. 3; ISO 15484",
        looks_like="torque that is not proportional to pressure, at any speed and temperature",
        parameters=(Parameter("pressure_slope", "1/Pa", -8e-8, 8e-8, -2e-8, 2e-8),),
    ),
    friction=friction,
)
