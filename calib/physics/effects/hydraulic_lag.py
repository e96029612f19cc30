"""Hydraulic lag: the calipers fill slowly through narrow lines."""

from calib.physics.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.physics.history import RunHistory
from calib.physics.lag import first_order


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] after a first-order lag, the same on both axles.

    Steady state at the first sample. Not valid for a line that fills faster than it empties.
    """
    lag = parameters["time_constant"]
    if lag <= 0.0:
        return p_f, p_r
    return first_order(history.time, p_f, lag), first_order(history.time, p_r, lag)


EFFECT = Effect(
    card=Card(
        name="hydraulic_lag",
        cause="flow resistance of the lines and volume taken by the calipers",
        equation="T dp/dt + p = p_mc; no effect at time_constant = 0",
        source="Limpert, Brake Design and Safety, ch. 5; Breuer and Bill, Brake Technology",
        looks_like="torque that follows changes of pressure late and rounded; none when held",
        parameters=(Parameter("time_constant", "s", 0.0, 1.0, 0.1, 0.06),),
    ),
    pressure=pressure,
)
