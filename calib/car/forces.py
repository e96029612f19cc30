"""Equations (1) to (22) of the paper: loads, torques, slips and normalised forces.

    pads --(2) (3)--> brake torque T_b --(1)--> tyre force F_x
    F_x over the axle load F_z (6) (7) --> normalised force F --(11) (12) (18)--> D, f1, f2

Sign convention: z = -a_x/g, so z, forces, torques and slips are positive when the car brakes. The
paper prints (6)-(8), (13), (14) for a forward-positive a_x and (11), (12), (17) for a positive
deceleration; here all of them use z. Every function says whether it is per wheel or per axle.
The ratios (8) to (10) follow from the loads: F_xf/F_xr = F_f F_zf/(F_r F_zr).
Valid on a flat road in a straight line, without aerodynamic pitch moment, and with a load transfer
that follows the deceleration at once.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car.vehicle import Axle, Vehicle


def deceleration(a_x: Array) -> Array:
    """Deceleration z = -a_x/g [1] from a forward-positive ``a_x`` [m/s^2], both any shape."""
    return -a_x / G


def axle_loads(vehicle: Vehicle, z: Array) -> tuple[Array, Array]:
    """Normal force of the front and the rear axle [N] at the deceleration z [1], (6) and (7).

    Quasi-static: not valid while the body pitches, nor above z = l_f/h, where the rear wheels lift.
    """
    load_per_length = vehicle.weight / vehicle.wheelbase  # W/L
    F_zf = load_per_length * (vehicle.cg_to_rear_axle + z * vehicle.cg_height)  # (6)
    F_zr = load_per_length * (vehicle.cg_to_front_axle - z * vehicle.cg_height)  # (7)
    return F_zf, F_zr


def brake_torque(axle: Axle, pad_friction: Array | float, pressure: Array) -> Array:
    """Brake torque of one wheel [N m] at ``pressure`` [Pa], (2) and (3), both pad faces."""
    return pad_friction * axle.torque_gain * pressure  # (2), (3): T_b = mu_p C P


def tyre_force(
    axle: Axle, torque: Array, spin_rate: Array, drag_moment: Array | float = 0.0
) -> Array:
    """Tyre force of one wheel [N] from its brake torque [N m], (1).

    ``spin_rate`` is d omega/dt [rad/s^2], negative while braking. ``drag_moment`` [N m] is the sum
    of all other moments that slow the wheel, such as rolling resistance.
    """
    return (axle.wheel_inertia * spin_rate + torque + drag_moment) / axle.rolling_radius  # (1)


def paper_curves(vehicle: Vehicle, z: Array, D: Array) -> tuple[Array, Array]:
    """f1 and f2 [1] of (11), (12) from D = F_f - F_r [1] at z [1]; any D satisfies (18)."""
    F_zf, F_zr = axle_loads(vehicle, z)
    F_z = F_zf + F_zr
    return D * F_zr / F_z, -D * F_zf / F_z  # (18): f1 = -(F_zr/F_zf) f2


def slip(axle: Axle, omega: Array, v: Array) -> Array:
    """Braking slip lambda [1] of a wheel at ``omega`` [rad/s] and speed ``v`` [m/s], (19), (20)."""
    return (v - axle.rolling_radius * omega) / v  # (19), (20)


def mean_slip(vehicle: Vehicle, load_f: Array, omega_f: Array, omega_r: Array, v: Array) -> Array:
    """Mean slip of the axles [1] (n,), weighted by their loads, from (19), (20); NaN at rest.

    ``load_f`` is the load of the front axle [N], ``omega_f`` and ``omega_r`` are the mean wheel
    speeds of the axles [rad/s], ``v`` [m/s]; all (n,). The slip that the sensors read while the car
    rolls freely is not subtracted.
    """
    share = load_f / vehicle.weight
    rim_speed = share * vehicle.front.rolling_radius * omega_f  # R omega, weighted [m/s]
    rim_speed += (1.0 - share) * vehicle.rear.rolling_radius * omega_r
    is_moving = v > 0.0
    return np.where(is_moving, 1.0 - rim_speed / np.where(is_moving, v, 1.0), np.nan)


def wheel_speed(axle: Axle, slip: Array, v: Array) -> Array:
    """Wheel speed omega [rad/s] at braking ``slip`` [1] and ``v`` [m/s]; (21) solved for omega."""
    return v * (1.0 - slip) / axle.rolling_radius  # (21)


def speed_ratio(slip_f: Array, slip_r: Array) -> Array:
    """Eta [1], rear over front rim speed, from the slips of the axles [1], (22)."""
    return (1.0 - slip_r) / (1.0 - slip_f)  # (22)
