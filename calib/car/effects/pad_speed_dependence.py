"""Speed dependence of the pads: friction that changes with the sliding speed."""

from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory

REFERENCE_SPEED = 20.0
"""Speed [m/s] at which the pad friction is that of the model; the middle of a usual stop, where
the estimates of slope and level are least correlated."""


def friction(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Factor 1 + k (v - 20 m/s) [1] on both axles; a straight line, wrong far from 20 m/s."""
    factor = 1.0 + parameters["speed_slope"] * (history.v - REFERENCE_SPEED)
    return factor, factor


EFFECT = Effect(
    card=Card(
        name="pad_speed_dependence",
        cause="pad friction changes with the sliding speed",
        equation="mu_p (1 + k (v - 20 m/s)); no effect at speed_slope = 0",
        source="Limpert, Brake Design and Safety, ch. 3; ISO 15484",
        looks_like="torque that grows (k < 0) towards the end of a stop at constant pressure",
        parameters=(Parameter("speed_slope", "s/m", -0.02, 0.02, -0.004, 0.004),),
    ),
    friction=friction,
)
