"""Effects of the sensors: what they read differs, the car moves as without them."""

from calib.base.arrays import Array
from calib.car.effects.effect import Parameters, effect
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
        accelerometer=lambda vehicle, own, history, a_x: a_x * (1.0 + own["scale_error"]),
    ),
    effect(
        "accelerometer_bias",
        accelerometer=lambda vehicle, own, history, a_x: a_x + own["bias"],
    ),
    effect("accelerometer_lag", accelerometer_lag=_filtered),
    effect("speed_delay", speed_delay=lambda parameters: parameters["v_delay"]),
    effect("wheel_speed_delay", wheel_speed_delay=lambda parameters: parameters["omega_delay"]),
    effect("tone_ring_runout", wheel_speed=_off_centre),
)
