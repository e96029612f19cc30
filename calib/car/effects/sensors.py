"""Effects of the sensors: what they read differs, the car moves as without them."""

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effect import Parameter, Parameters, effect
from calib.car.history import Motion
from calib.car.vehicle import Vehicle


def _filtered(parameters: Parameters) -> tuple[float, float]:
    """T, and q T^2; q, ``filter_bend``, is 0 where it is not given: first order.

    A filter of a higher order is close to one of second order with the same delay.
    """
    T = parameters["filter_time"]
    return T, parameters.get("filter_bend", 0.0) * T**2


def _off_centre(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> dict[str, Array]:
    """``runout_side`` is 1 when only the left ring runs out, -1 only the right one, 0 both in step.

    The angle counts from the first sample, unless its origin was set by the ripple of the run: low
    where a disc of uneven thickness would slow the wheel. Not valid for a ring with a damaged
    tooth: that is a spike once a turn.
    """
    a, side = parameters["runout"], parameters["runout_side"]
    turned = a * motion.history.ripple(parameters["runout_phase"])
    left, right = min(1.0, 1.0 + side), min(1.0, 1.0 - side)
    return {"fl": 1.0 - left * turned, "fr": 1.0 - right * turned}


EFFECTS = (
    effect(
        "accelerometer_scale",
        Parameter("scale_error", "1", -0.2, 0.2, 0.03, 0.02),
        cause="scale factor error of the sensor",
        equation="a_x (1 + e); no effect at scale_error = 0",
        source="IEEE Std 1293, scale factor",
        looks_like="an error of a_x in proportion to the deceleration, not shown by wheel speeds",
        accelerometer=lambda vehicle, parameters, history, a_x: (
            a_x * (1.0 + parameters["scale_error"])
        ),
    ),
    effect(
        "accelerometer_bias",
        Parameter("bias", "m/s^2", -1.0, 1.0, 0.1, 0.1),
        cause="zero error or tilted mounting of the sensor",
        equation="a_x + b; no effect at bias = 0",
        source="IEEE Std 1293, bias",
        looks_like="a constant error of a_x, coasting and braking, that wheel speeds do not show",
        accelerometer=lambda vehicle, parameters, history, a_x: a_x + parameters["bias"],
    ),
    effect(
        "accelerometer_lag",
        Parameter("filter_time", "s", 0.0, 0.3, 0.02, 0.015),
        Parameter("filter_bend", "1", 0.0, 0.6, 0.25, 0.2, default=0.0),
        cause="low-pass filter of the sensor or of the bus, or a_x that is logged late",
        equation="q T^2 a'' + T a' + a = a_x; no effect at filter_time = 0",
        source="first order: T = 1/(2 pi f) with the corner frequency f, q = 0; Butterworth's "
        "second order: T = sqrt(2)/(2 pi f), q = 0.5",
        looks_like="errors of a_x at bite and release alone; wheel speeds and v show none",
        accelerometer_lag=_filtered,
    ),
    effect(
        "speed_delay",
        Parameter("v_delay", "s", 0.0, 0.5, 0.05, 0.03),
        cause="latency of the reference speed: the computing time of a satellite receiver, a bus",
        equation="v(t - T_v); no effect at v_delay = 0",
        source="data sheets of satellite speed sensors: 5 to 150 ms",
        looks_like="a slip of all wheels in proportion to the deceleration over the speed",
        speed_delay=lambda parameters: parameters["v_delay"],
    ),
    effect(
        "wheel_speed_delay",
        Parameter("omega_delay", "s", 0.0, 0.3, 0.02, 0.015),
        cause="wheel speeds that are averaged over teeth or sent over a bus",
        equation="omega(t - T_w); no effect at omega_delay = 0",
        source="message cycle of a brake control unit: 10 to 20 ms, after a mean over the teeth",
        looks_like="a negative slip of all wheels in proportion to deceleration over speed",
        wheel_speed_delay=lambda parameters: parameters["omega_delay"],
    ),
    effect(
        "tone_ring_runout",
        Parameter("runout", "1", 0.0, 0.03, 0.001, 0.0007),
        Parameter("runout_phase", "rad", -np.pi, np.pi, 0.0, 1.0),
        Parameter("runout_side", "1", -1.0, 1.0, 0.0, 0.8),
        cause="a tone ring that is not centred on its hub: an error of the sensor, not of the car",
        equation="omega (1 - a sin(angle + phase)), 1 or 2 front rings; no effect at runout = 0",
        source="an eccentric ring of radius r, off by e: a = e/r",
        looks_like="a front wheel speed that pulses with the turn of its wheel, braked or not, "
        "and nothing in a_x; no base parameter absorbs it",
        wheel_speed=_off_centre,
    ),
)
