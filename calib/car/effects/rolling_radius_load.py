"""Rolling radius over load: a tyre under more load rolls on a smaller radius."""

import numpy as np

from calib.base.names import AXLES
from calib.car.effects.effect import Array, Card, Effect, Parameter, Parameters
from calib.car.forces import axle_loads
from calib.car.history import Motion
from calib.car.vehicle import Vehicle


def wheel_speed(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> dict[str, Array]:
    """Factors exp(q (F_z/F_z0 - 1)) [1] on the speeds of all wheels, F_z0 the load at rest.

    The same form as ``radius_load`` of `calib.car.tyre.AxleTyres`. The torque that goes with
    the smaller radius, 0.1 to 0.5 % of it, is neglected. Not valid for other inflation than at the
    measurement of the radius.
    """
    q = parameters["radius_load"]
    rest = axle_loads(vehicle, np.zeros(1))
    loads = (motion.load_f, motion.load_r)
    return {
        f"{axle}{side}": np.exp(q * (load / at_rest[0] - 1.0))
        for axle, load, at_rest in zip(AXLES, loads, rest, strict=True)
        for side in "lr"
    }


EFFECT = Effect(
    card=Card(
        name="rolling_radius_load",
        cause="tyres that are pressed flatter under the load transfer of braking",
        equation="omega exp(q (F_z/F_z0 - 1)); no effect at radius_load = 0",
        source="Pacejka, Tyre and Vehicle Dynamics, ch. 1 (effective rolling radius)",
        looks_like=(
            "front wheels that turn faster and rear ones slower in proportion to the deceleration; "
            "pads, tyre stiffness and peak absorb most of it: stops from the same speed on dry and "
            "wet roads, or hard stops beside ramps to the peak, show it"
        ),
        parameters=(Parameter("radius_load", "1", 0.0, 0.03, 0.004, 0.002),),
    ),
    wheel_speed=wheel_speed,
)
