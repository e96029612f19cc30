"""The force balance of a car: the forces of tyres and brakes at a given deceleration.

    W z = tyre forces + body forces          tyre forces = brakes + other moments on the wheels

The other moments come from known effects, from the inertia of the wheels, and from a logged torque
of engine or motor. Valid for quasi-static loads in a straight line.

    friction used |      front ___.--   an axle locks where it uses what the road offers;
                  | __.--'  .--'        the axle that uses more locks first
                  |   rear-'
                  +---------------- z

The picture is for one pressure on both axles, without drag, slip control and wheel inertia, as (9).
"""

import math
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car.effects.combined import total_axle_moment, total_body_force, total_load_shift
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads
from calib.car.history import Motion, constant_speed
from calib.car.vehicle import Vehicle

T = TypeVar("T", float, Array)


@dataclass(frozen=True)
class ForceBalance:
    """Forces of a run [N], shapes (n,).

    ``load_f``, ``load_r`` axle loads (6), (7) with known effects; ``drag_f``, ``drag_r`` moments
    that slow the wheels besides the brakes, over the rolling radius: drag less drive, where the
    inertia of slowing wheels counts as drive; ``drag_no_inertia_f``, ``..._r`` without it; ``body``
    forces that slow the body directly; ``tyre_sum`` sum of all tyre forces (5), (17).
    """

    load_f: Array
    load_r: Array
    drag_f: Array
    drag_r: Array
    drag_no_inertia_f: Array
    drag_no_inertia_r: Array
    body: Array
    tyre_sum: Array

    @property
    def demanded(self) -> Array:
        """Brake force of both axles by the deceleration [N]."""
        return self.tyre_sum - self.drag_f - self.drag_r


def force_balance(
    vehicle: Vehicle,
    effects: Effects,
    time: Array,
    speed: Array,
    z: Array,
    pressure: Array,
    drive: tuple[Array, Array] | None = None,
    spin: tuple[Array, Array] | None = None,
) -> ForceBalance:
    """Balance at ``time`` [s], ``speed`` [m/s], ``z`` [1] and ``pressure`` [Pa], shapes (n,).

    ``drive`` torque of engine or motor at the front and the rear wheels [N m per axle], negative
    where it slows; ``spin`` d omega/dt of the front and the rear wheels [rad/s^2], by default
    -g z/R, which neglects the change of slip.
    """
    load_f, load_r = axle_loads(vehicle, z)
    history = replace(constant_speed(time, pressure, 0.0), v=speed, z=z)
    motion = Motion(speed, load_f, load_r, history)
    moments = total_axle_moment(vehicle, effects, motion)
    axles = (vehicle.front, vehicle.rear)
    if spin is None:
        spin = (-G * z / vehicle.front.rolling_radius, -G * z / vehicle.rear.rolling_radius)
    if drive is None:
        drive = (np.zeros_like(z), np.zeros_like(z))
    net = tuple(moment - torque for moment, torque in zip(moments, drive, strict=True))
    drag_f, drag_r = (
        np.asarray((moment + 2.0 * axle.wheel_inertia * rate) / axle.rolling_radius)  # (1)
        for axle, moment, rate in zip(axles, net, spin, strict=True)
    )
    body = total_body_force(vehicle, effects, motion)
    shift = vehicle.weight * total_load_shift(vehicle, effects, history)
    return ForceBalance(
        load_f=load_f - shift,
        load_r=load_r + shift,
        drag_f=drag_f,
        drag_r=drag_r,
        drag_no_inertia_f=net[0] / vehicle.front.rolling_radius,
        drag_no_inertia_r=net[1] / vehicle.rear.rolling_radius,
        body=body,
        tyre_sum=vehicle.weight * z - body,  # (5), (17)
    )


def rotating_shares(vehicle: Vehicle) -> tuple[float, float]:
    """Equivalent mass of the front and the rear wheels over the mass of the car [1]."""
    front, rear = (2.0 * axle.wheel_mass / vehicle.mass for axle in (vehicle.front, vehicle.rear))
    return front, rear


def tyre_forces(
    vehicle: Vehicle, share: Array | float, brake: Array, inertia: Array
) -> tuple[Array, Array]:
    """Tyre forces of the axles where the brakes alone slow the car, (13), (14).

    ``brake`` force of both axles; ``share`` of the front one in it [1]; ``inertia`` -M dv/dt. The
    inertia of the wheels takes its part of the brake force. All in N, or all over the weight.
    """
    front, rear = rotating_shares(vehicle)
    return share * brake - front * inertia, (1.0 - share) * brake - rear * inertia


def brake_forces(
    vehicle: Vehicle, p_f: Array, p_r: Array, log_ratio: Array | float = 0.0
) -> tuple[Array, Array]:
    """Brake force of each axle at the road [N] by (2), nominal pads times exp(+-log_ratio/2)."""
    front, rear = vehicle.front, vehicle.rear
    gain_f = 2.0 * front.torque_gain * front.pad_friction / front.rolling_radius
    gain_r = 2.0 * rear.torque_gain * rear.pad_friction / rear.rolling_radius
    half = np.exp(0.5 * np.asarray(log_ratio))
    return gain_f * half * p_f, gain_r / half * p_r


def force_per_pressure(vehicle: Vehicle) -> tuple[float, float]:
    """Brake force of the front and of the rear axle at the road per pressure [N/Pa], (2)."""
    unit = np.ones(1)
    front, rear = brake_forces(vehicle, unit, unit)
    return float(front[0]), float(rear[0])


def pressure_per_g(vehicle: Vehicle) -> float:
    """Pressure that decelerates the car by g [Pa], (5) with nominal pads."""
    return vehicle.weight / sum(force_per_pressure(vehicle))


def front_share(vehicle: Vehicle, log_ratio: T) -> T:
    """Share of the front axle in the brake force [1], the same at every pressure.

    ``log_ratio`` ln of front over rear pads, less that of the vehicle file [1], plus ln of front
    over rear pressure where these differ.
    """
    front, rear = force_per_pressure(vehicle)
    share: T = front / (front + rear * math.e**-log_ratio)
    return share


def front_biased_up_to(vehicle: Vehicle) -> float:
    """z [1] at which F_f = F_r with nominal pads: the car is front-biased below it.

    From (2), (9) and the I curve: there the front share of the tyre force equals that of the load.
    Infinite without a rear brake; zero where the car is rear-biased at every z.
    """
    share = front_share(vehicle, 0.0)
    z = (share * vehicle.wheelbase - vehicle.cg_to_rear_axle) / vehicle.cg_height
    return math.inf if share == 1.0 else max(z, 0.0)


def lock_efficiency(vehicle: Vehicle, friction: float) -> float:
    """z at which the first axle locks over the ``friction`` of the road [1]; at most 1."""
    share, L, h = front_share(vehicle, 0.0), vehicle.wheelbase, vehicle.cg_height
    lever = share * L - friction * h  # phi z L = mu (l_r + z h), from (6)
    front = vehicle.cg_to_rear_axle / lever if lever > 0.0 else math.inf
    return min(front, vehicle.cg_to_front_axle / ((1.0 - share) * L + friction * h))  # from (7)
