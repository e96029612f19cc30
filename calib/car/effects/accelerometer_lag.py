"""Accelerometer lag: the reading is filtered, so it follows the deceleration."""

from calib.car.effects.effect import Card, Effect, Parameter, Parameters


def accelerometer_lag(parameters: Parameters) -> tuple[float, float]:
    """Time constant T [s] of a low-pass, and the factor q T^2 [s^2] of its second order.

    q, ``filter_bend``, is 0 where it is not given: first order. A filter of a higher order is close
    to one of second order with the same delay.
    """
    T = parameters["filter_time"]
    return T, parameters.get("filter_bend", 0.0) * T**2


EFFECT = Effect(
    card=Card(
        name="accelerometer_lag",
        cause="low-pass filter of the sensor or of the bus, or a_x that is logged late",
        equation="q T^2 a'' + T a' + a = a_x; no effect at filter_time = 0",
        source=(
            "first order: T = 1/(2 pi f) with the corner frequency f, q = 0; Butterworth's second "
            "order: T = sqrt(2)/(2 pi f), q = 0.5"
        ),
        looks_like="errors of a_x at bite and release alone; wheel speeds and v show none",
        parameters=(
            Parameter("filter_time", "s", 0.0, 0.3, 0.02, 0.015),
            Parameter("filter_bend", "1", 0.0, 0.6, 0.25, 0.2, default=0.0),
        ),
    ),
    accelerometer_lag=accelerometer_lag,
)
