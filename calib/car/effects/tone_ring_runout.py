"""Tone ring runout: a wheel speed sensor whose ring is not centred reads a ripple once a turn."""

import numpy as np

from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.history import Motion
from calib.car.vehicle import Vehicle


def wheel_speed(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> dict[str, Array]:
    """Factors 1 - a sin(angle + phase) [1] on the readings of the front wheels.

    ``runout_side`` is 1 when only the left ring runs out, -1 only the right one, 0 both in step.
    The angle counts from the first sample, unless its origin was set by the ripple of the run
    (`calib.diagnose`): low where a disc of uneven thickness would slow the wheel. Not valid for
    a ring with a damaged tooth: that is a spike once a turn.
    """
    a, side = parameters["runout"], parameters["runout_side"]
    turned = a * motion.history.ripple(parameters["runout_phase"])
    left, right = min(1.0, 1.0 + side), min(1.0, 1.0 - side)
    return {"fl": 1.0 - left * turned, "fr": 1.0 - right * turned}


EFFECT = Effect(
    card=Card(
        name="tone_ring_runout",
        cause="a tone ring that is not centred on its hub: an error of the sensor, not of the car",
        equation="omega (1 - a sin(angle + phase)), 1 or 2 front rings; no effect at runout = 0",
        source="an eccentric ring of radius r, off by e: a = e/r",
        looks_like=(
            "a front wheel speed that pulses with the turn of its wheel, braked or not, and "
            "nothing in a_x; no base parameter absorbs it"
        ),
        parameters=(
            Parameter("runout", "1", 0.0, 0.03, 0.001, 0.0007),
            Parameter("runout_phase", "rad", -np.pi, np.pi, 0.0, 1.0),
            Parameter("runout_side", "1", -1.0, 1.0, 0.0, 0.8),
        ),
    ),
    wheel_speed=wheel_speed,
)
