"""Engine drag: the closed throttle slows the driven wheels."""

from calib.car.effects.effect import Card, Effect, Pair, Parameter, Parameters
from calib.car.history import Motion
from calib.car.vehicle import Vehicle

SPEED = 20.0
"""Speed at which the torque is told [m/s]."""


def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """M = M_e (1 + g (v - 20 m/s)), 1 - s of it at the front, s at the rear [N m per axle].

    Friction and pumping of an engine grow with its speed. ``drag_growth`` and ``drag_rear_share``
    are 0 where they are not given: a car with driven front wheels. Valid for one gear. Negative
    while the engine or a torque converter still drives the car. A logged ``T_drive_f`` or
    ``T_drive_r`` counts besides: the effect is what the log does not hold.
    """
    grown = 1.0 + parameters.get("drag_growth", 0.0) * (motion.v - SPEED)
    moment, share = parameters["drag_torque"] * grown, parameters.get("drag_rear_share", 0.0)
    return (1.0 - share) * moment, share * moment


EFFECT = Effect(
    card=Card(
        name="engine_drag",
        cause="engine in gear with closed throttle, at the driven axle or at both",
        equation=(
            "M = M_e (1 + g (v - 20 m/s)), 1 - s of it on the front axle, s on the rear one; no "
            "effect at drag_torque = 0"
        ),
        source=(
            "Gillespie, Fundamentals of Vehicle Dynamics, ch. 2; growth: Heywood, Internal "
            "Combustion Engine Fundamentals, ch. 13"
        ),
        looks_like="a nearly constant deceleration, braked or not; the driven axle alone slips",
        parameters=(
            Parameter("drag_torque", "N*m", -500.0, 1500.0, 150.0, 100.0),
            Parameter("drag_growth", "s/m", -0.02, 0.05, 0.008, 0.006, default=0.0),
            Parameter("drag_rear_share", "1", 0.0, 1.0, 0.0, 0.5, default=0.0, share=True),
        ),
    ),
    axle_moment=axle_moment,
)
