"""A car whose axles brake as hard for their load at a deceleration that one asks for."""

from dataclasses import replace

from calib.car.vehicle import Vehicle


def balanced(car: Vehicle, z: float) -> Vehicle:
    """The car with rear pistons that brake as hard for their load as the front ones at ``z`` [1].

    The front share of the brake force is then that of the load: it is front-biased below ``z``.
    """
    share = (car.cg_to_rear_axle + z * car.cg_height) / car.wheelbase
    front, rear = (
        a.torque_gain * a.pad_friction / a.rolling_radius / a.piston_area
        for a in (car.front, car.rear)
    )
    area = car.front.piston_area * front / rear * (1.0 - share) / share
    return replace(car, rear=replace(car.rear, piston_area=area))
