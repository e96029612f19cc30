"""Accelerometer lag: the reading is filtered, so it follows the deceleration."""

from calib.physics.effects.effect import Card, Effect, Parameter, Parameters


def accelerometer_lag(parameters: Parameters) -> float:
    """Time constant [s] of a low-pass of first order. A filter of higher order is a delay, too:
    one of first order with the same delay stands for it where the pedal is slower than it.
    """
    return parameters["filter_time"]


EFFECT = Effect(
    card=Card(
        name="accelerometer_lag",
        cause="low-pass filter of the sensor or of the bus, or a_x that is logged late",
        equation="T d(a)/dt + a = a_x; no effect at filter_time = 0",
        source="first order, T = 1/(2 pi f) with the corner frequency f of the filter",
        looks_like="errors of a_x at bite and release alone; wheel speeds and v show none",
        parameters=(Parameter("filter_time", "s", 0.0, 0.3, 0.02, 0.015),),
    ),
    accelerometer_lag=accelerometer_lag,
)
