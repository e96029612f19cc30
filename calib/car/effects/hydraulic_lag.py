"""Hydraulic lag: the calipers fill slowly through narrow lines."""

from calib.car.effects.effect import Array, Card, Effect, Pair, Parameter, Parameters
from calib.car.history import RunHistory
from calib.car.lag import low_pass


def pressure(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure [Pa] after a lag that does not overshoot, the same on both axles.

    Steady state at the first sample. q, ``lag_bend``, is 0 where it is not given: first order; 1/4
    is two lags of T/2 in a row, more would swing (`hydraulic_oscillation`). Not valid for a line
    that fills faster than it empties.
    """
    T = parameters["time_constant"]
    if T <= 0.0:
        return p_f, p_r
    second = parameters.get("lag_bend", 0.0) * T**2
    front = low_pass(history.time, p_f, T, second)
    return front, front if p_r is p_f else low_pass(history.time, p_r, T, second)


EFFECT = Effect(
    card=Card(
        name="hydraulic_lag",
        cause="flow resistance of the lines and volume taken by the calipers",
        equation="q T^2 p'' + T p' + p = p_mc; no effect at time_constant = 0",
        source="Limpert, Brake Design and Safety, ch. 5; Breuer and Bill, Brake Technology",
        looks_like="torque that follows changes of pressure late and rounded; none when held",
        parameters=(
            Parameter("time_constant", "s", 0.0, 1.0, 0.1, 0.06),
            Parameter("lag_bend", "1", 0.0, 0.25, 0.1, 0.1, default=0.0),
        ),
    ),
    pressure=pressure,
)
