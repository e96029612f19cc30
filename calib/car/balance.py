"""The force balance of a car: the forces of tyres and brakes at a given deceleration.

    W z = tyre forces + body forces
    tyre force of an axle = brake force + (other moments on its wheels)/R

Body forces are those of known effects, such as air drag. The other moments come from known effects,
from the inertia of the wheels, and from a logged torque of engine or motor. Valid for quasi-static
loads in a straight line.

The second half of the file is the distribution of the brake force between the axles, for equal
pressure on both axles and without drag, slip control and wheel inertia, as in (9):

    F |      front ___.--      an axle locks where its normalised force F reaches the friction
      | __.--'  .--'           of the road: the axle with the larger F locks first
      |   rear-'
      +---------------- z
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
    """Forces of a run [N], shapes (n,); all but the loads are positive when they slow the car.

    The drag of an axle is the sum of the other moments on its wheels over the rolling radius. The
    inertia of slowing wheels drives the car on, so this inertia makes the drag smaller.
    """

    load_f: Array  # axle loads (6), (7), with the known effects on them
    load_r: Array
    drag_f: Array
    drag_r: Array
    drag_no_inertia_f: Array  # drag without the inertia of the wheels
    drag_no_inertia_r: Array
    body: Array  # sum of the forces that slow the body directly
    tyre_sum: Array  # sum of all tyre forces (5), (17)

    @property
    def demanded(self) -> Array:
        """Brake force of both axles together [N] (n,), as the deceleration demands it."""
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

    ``drive`` is the torque of engine or motor at the front and the rear wheels [N m per axle],
    negative where it slows. ``spin`` is d omega/dt of the front and the rear wheels [rad/s^2]; its
    default -g z/R neglects the change of slip.
    """
    front, rear = vehicle.front, vehicle.rear
    load_f, load_r = axle_loads(vehicle, z)
    history = replace(constant_speed(time, pressure, 0.0), v=speed, z=z)  # no angles, no heat
    motion = Motion(speed, load_f, load_r, history)
    moment_f, moment_r = total_axle_moment(vehicle, effects, motion)
    if drive is not None:
        moment_f, moment_r = moment_f - drive[0], moment_r - drive[1]
    if spin is None:
        spin = (-G * z / front.rolling_radius, -G * z / rear.rolling_radius)
    body = total_body_force(vehicle, effects, motion)
    shift = vehicle.weight * total_load_shift(vehicle, effects, history)
    return ForceBalance(
        load_f=load_f - shift,
        load_r=load_r + shift,
        drag_f=(moment_f + 2.0 * front.wheel_inertia * spin[0]) / front.rolling_radius,  # (1)
        drag_r=(moment_r + 2.0 * rear.wheel_inertia * spin[1]) / rear.rolling_radius,
        drag_no_inertia_f=moment_f / front.rolling_radius,
        drag_no_inertia_r=moment_r / rear.rolling_radius,
        body=body,
        tyre_sum=vehicle.weight * z - body,  # (5), (17)
    )


def rotating_shares(vehicle: Vehicle) -> tuple[float, float]:
    """`Axle.wheel_mass` of both wheels of an axle over the mass of the car [1], front and rear."""
    front, rear = vehicle.front.wheel_mass, vehicle.rear.wheel_mass
    return 2.0 * front / vehicle.mass, 2.0 * rear / vehicle.mass


def tyre_forces(
    vehicle: Vehicle, share: Array | float, brake: Array, inertia: Array
) -> tuple[Array, Array]:
    """Tyre forces of the axles where the brakes alone slow the car, (13), (14).

    ``brake`` is the brake force of both axles, ``share`` that of the front axle in ``brake`` [1],
    ``inertia`` is -M dv/dt. A part of the brake force slows the wheels themselves. All forces are
    in N, or all are over the weight.
    """
    mass_f, mass_r = rotating_shares(vehicle)  # over the mass of the car
    return share * brake - mass_f * inertia, (1.0 - share) * brake - mass_r * inertia


def brake_forces(
    vehicle: Vehicle, p_f: Array, p_r: Array, log_ratio: Array | float = 0.0
) -> tuple[Array, Array]:
    """Brake force of the front and the rear axle at the road [N] at pressures [Pa], by (2).

    ``log_ratio`` is ln of front over rear pad friction, less that of the vehicle file [1]: the
    nominal front pads are multiplied by exp(log_ratio/2), the rear pads are divided by it.
    """
    gain_f, gain_r = force_per_pressure(vehicle)
    factor = np.exp(0.5 * np.asarray(log_ratio))
    return gain_f * factor * p_f, gain_r / factor * p_r


def force_per_pressure(vehicle: Vehicle) -> tuple[float, float]:
    """Brake force of the front and of the rear axle at the road per pressure [N/Pa], (2)."""
    front, rear = vehicle.front, vehicle.rear
    gain_f = 2.0 * front.torque_gain * front.pad_friction / front.rolling_radius
    return gain_f, 2.0 * rear.torque_gain * rear.pad_friction / rear.rolling_radius


def pressure_per_g(vehicle: Vehicle) -> float:
    """Pressure that decelerates the car by g [Pa], (5) with nominal pads."""
    return vehicle.weight / sum(force_per_pressure(vehicle))


def front_share(vehicle: Vehicle, log_ratio: T) -> T:
    """Share phi of the front axle in the brake force [1], the same at every pressure.

    ``log_ratio`` is ln of front over rear pad friction, less that of the vehicle file [1]. Where
    the pressures of the axles differ, add ln of front over rear pressure.
    """
    front, rear = force_per_pressure(vehicle)
    share: T = front / (front + rear * math.e**-log_ratio)
    return share


def front_biased_up_to(vehicle: Vehicle) -> float:
    """z [1] up to which the front axle has the larger F with nominal pads; zero if it never has.

    At this z the front axle has the same share in the brake force as in the load, by (2), (6), (9):
    phi L = l_r + z h. Infinite without a rear brake.
    """
    phi = front_share(vehicle, 0.0)
    z = (phi * vehicle.wheelbase - vehicle.cg_to_rear_axle) / vehicle.cg_height
    return math.inf if phi == 1.0 else max(z, 0.0)


def lock_efficiency(vehicle: Vehicle, friction: float) -> float:
    """z/mu [1] at which the first axle locks on a road of ``friction`` mu; at most 1.

    An axle locks where its brake force is mu times its load: the front axle where
    phi z L = mu (l_r + z h), by (6), the rear axle where (1 - phi) z L = mu (l_f - z h), by (7).
    """
    phi, L, h = front_share(vehicle, 0.0), vehicle.wheelbase, vehicle.cg_height
    divisor = phi * L - friction * h
    front_locks_at = vehicle.cg_to_rear_axle / divisor if divisor > 0.0 else math.inf
    rear_locks_at = vehicle.cg_to_front_axle / ((1.0 - phi) * L + friction * h)
    return min(front_locks_at, rear_locks_at)
