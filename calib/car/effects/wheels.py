"""Effects of wheels, tyres and drive: moments besides the brake, inertia and radii.

Motor:  M ^  M_0 ________
          |     /        '-.._  P/omega
          |    /
          +---'-----------------> v

Effects add to a logged ``T_drive_f`` or ``T_drive_r``.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES
from calib.car.braking import BITE
from calib.car.effects.effect import Pair, Parameters, effect
from calib.car.forces import axle_loads
from calib.car.history import Motion
from calib.car.lag import first_order
from calib.car.vehicle import Vehicle

_SPEED = 20.0
"""Speed [m/s] at which rolling resistance and the torque of an engine are given."""

_BLEND = 0.4
"""Default ``regen_span`` over ``regen_onset`` [1]."""

FADE_OUT = 3.0
"""Speed below which the motor hands over to the brakes [m/s], as usual for a blended stop."""


def _rolling(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """c_rr F_z R [N m per axle], growing with v^2 by ``rolling_growth``, by default 0."""
    growth = 1.0 + parameters.get("rolling_growth", 0.0) * ((motion.v / _SPEED) ** 2 - 1.0)
    c_rr = parameters["coefficient"] * growth
    return (
        c_rr * motion.load_f * vehicle.front.rolling_radius,
        c_rr * motion.load_r * vehicle.rear.rolling_radius,
    )


def _engine(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """Moment of friction and pumping of an engine [N m per axle], which grows with its speed.

    ``drag_growth`` and ``drag_rear_share`` are 0 by default: driven front wheels. Negative while
    the engine or a torque converter still drives the car. Valid for one gear.
    """
    growth = 1.0 + parameters.get("drag_growth", 0.0) * (motion.v - _SPEED)
    moment, share = parameters["drag_torque"] * growth, parameters.get("drag_rear_share", 0.0)
    return (1.0 - share) * moment, share * moment


def _motor(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """M = min(M_0, P/omega) [N m per axle] from a pressure on, shared by the axles.

    It grows from the pressure ``regen_onset`` on over ``regen_span``, and follows the pedal with
    the time constant ``regen_lag``, its limits at once. omega is that of free rolling: P is too
    high by the slip, 1 to 3 %. Not valid for a motor that slows without the brake (`engine_drag`).
    """
    share = parameters["regen_rear_share"]
    onset = parameters.get("regen_onset", BITE)
    span = parameters.get("regen_span", _BLEND * onset)
    braked = np.clip((motion.history.p_mc - onset) / span, 0.0, 1.0)
    lag = parameters.get("regen_lag", 0.0)
    if lag > 0.0:
        braked = first_order(motion.history.time, braked, lag)
    fading = np.clip(motion.v / FADE_OUT, 0.0, 1.0)
    omega = np.maximum(motion.v, 0.1) / vehicle.front.rolling_radius
    moment = np.minimum(parameters["regen_torque"], parameters["regen_power"] / omega)
    moment = moment * braked * fading
    return (1.0 - share) * moment, share * moment


def _radius_by_load(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> dict[str, Array]:
    """Factors on the wheel speeds: a radius falls with the load over that at rest.

    The change of torque, 0.1 to 0.5 %, is neglected. Valid at the inflation of the vehicle file.
    """
    q = parameters["radius_load"]
    static = axle_loads(vehicle, np.zeros(1))
    loads = (motion.load_f, motion.load_r)
    return {
        f"{axle}{side}": np.exp(q * (load / at_rest[0] - 1.0))
        for axle, load, at_rest in zip(AXLES, loads, static, strict=True)
        for side in "lr"
    }


ROLLING_RESISTANCE = effect("rolling_resistance", axle_moment=_rolling)
EFFECTS = (
    ROLLING_RESISTANCE,
    effect("engine_drag", axle_moment=_engine),
    effect("regenerative_torque", axle_moment=_motor),
    # Valid for one gear: the engine's share grows with the square of the ratio.
    effect("wheel_inertia", inertia=lambda parameters: (parameters["extra_inertia"], 0.0)),
    # The front radius is taken as right: a common error is one of the speed scale.
    effect(
        "rolling_radius_mismatch",
        radius=lambda parameters: (1.0, 1.0 + parameters["radius_mismatch"]),
    ),
    effect("rolling_radius_load", wheel_speed=_radius_by_load),
)
