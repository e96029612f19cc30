"""Effects of wheels, tyres and drive: moments on the wheels besides the brake, inertia, radii.

The moment M of a braking motor has two limits, a torque M_0 and a power P:

    M ^  M_0 ________
      |     /        '-.._  P/omega
      |    /
      +---'-----------------> v

The moments here are added to a logged ``T_drive_f`` or ``T_drive_r``.
"""

import numpy as np

from calib.base.arrays import Array
from calib.car.braking import BITE
from calib.car.effects.effect import Pair, Parameters, effect
from calib.car.history import Motion
from calib.car.lag import first_order
from calib.car.vehicle import Vehicle

_REFERENCE_SPEED = 20.0  # speed [m/s] of the parameters of rolling resistance and engine drag
_DEFAULT_SPAN = 0.4  # default of ``regen_span`` over ``regen_onset`` [1]
FADE_OUT = 3.0  # speed [m/s] below which the moment of a motor falls to zero, as is usual


def _rolling(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """c_rr F_z R [N m per axle]; ``rolling_growth``, by default 0, lets c_rr grow with v^2."""
    speed_ratio = motion.v / _REFERENCE_SPEED
    growth = 1.0 + parameters.get("rolling_growth", 0.0) * (speed_ratio**2 - 1.0)
    c_rr = parameters["coefficient"] * growth
    front = c_rr * motion.load_f * vehicle.front.rolling_radius
    return front, c_rr * motion.load_r * vehicle.rear.rolling_radius


def _engine(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """Moment of friction and pumping of an engine [N m per axle], which grows with the speed.

    By default ``drag_growth`` is 0, and ``drag_rear_share`` is 0: the front wheels are driven. The
    moment is negative while the engine drives the car. Valid for one gear.
    """
    growth = 1.0 + parameters.get("drag_growth", 0.0) * (motion.v - _REFERENCE_SPEED)
    moment, share = parameters["drag_torque"] * growth, parameters.get("drag_rear_share", 0.0)
    return (1.0 - share) * moment, share * moment


def _motor(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """M = min(M_0, P/omega) [N m per axle] times the blending by the pedal, shared by the axles.

    The blending grows from 0 to 1 while the pressure rises by ``regen_span`` from ``regen_onset``
    on, and follows the pedal with the time constant ``regen_lag``. omega is taken as v/R, so P is
    too high by the slip, 1 to 3 %. A motor that slows the car without the pedal is `engine_drag`.
    """
    share = parameters["regen_rear_share"]
    onset = parameters.get("regen_onset", BITE)
    span = parameters.get("regen_span", _DEFAULT_SPAN * onset)
    blending = np.clip((motion.history.p_mc - onset) / span, 0.0, 1.0)
    lag = parameters.get("regen_lag", 0.0)
    if lag > 0.0:
        blending = first_order(motion.history.time, blending, lag)
    fading = np.clip(motion.v / FADE_OUT, 0.0, 1.0)
    omega = np.maximum(motion.v, 0.1) / vehicle.front.rolling_radius
    moment = np.minimum(parameters["regen_torque"], parameters["regen_power"] / omega)
    moment = moment * blending * fading
    return (1.0 - share) * moment, share * moment


def _radius_by_load(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> dict[str, Array]:
    """Factors exp(q (F_z/F_z0 - 1)) [1] on the wheel speeds, since a radius falls with the load.

    F_z0 is the axle load at rest. The change of the brake force, 0.1 to 0.5 %, is neglected. Valid
    at the tyre inflation for which the radii of the vehicle file hold.
    """
    q, (static_f, static_r) = parameters["radius_load"], vehicle.static_loads
    front = np.exp(q * (motion.load_f / static_f - 1.0))
    rear = np.exp(q * (motion.load_r / static_r - 1.0))
    return {"fl": front, "fr": front, "rl": rear, "rr": rear}


ROLLING_RESISTANCE = effect("rolling_resistance", axle_moment=_rolling)
EFFECTS = (
    ROLLING_RESISTANCE,
    effect("engine_drag", axle_moment=_engine),
    effect("regenerative_torque", axle_moment=_motor),
    # valid for one gear: the inertia of an engine counts with the square of the gear ratio
    effect("wheel_inertia", inertia=lambda parameters: (parameters["extra_inertia"], 0.0)),
    # the front radius is taken as right: an error of both radii would be one of the scale of v
    effect(
        "rolling_radius_mismatch",
        radius=lambda parameters: (1.0, 1.0 + parameters["radius_mismatch"]),
    ),
    effect("rolling_radius_load", wheel_speed=_radius_by_load),
)
