"""Effects of wheels, tyres and drive: moments besides the brake, inertia and radii.

Motor:  M ^  M_0 ________
          |     /        '-.._  P/omega
          |    /
          +---'-----------------> v

A logged ``T_drive_f`` or ``T_drive_r`` counts besides: an effect is what the log does not hold.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLES
from calib.car.braking import BITE
from calib.car.effects.effect import Pair, Parameter, Parameters, effect
from calib.car.forces import axle_loads
from calib.car.history import Motion
from calib.car.lag import first_order
from calib.car.vehicle import Vehicle

_SPEED = 20.0
"""Speed [m/s] at which rolling resistance and the torque of an engine are told."""

_BLEND = 0.4
"""Range of pressures over which the motor sets in where none is given, over ``regen_onset`` [1]. A
brake light switch closes at one pressure; a motor takes a tenth of a second to build up its torque.
"""

FADE_OUT = 3.0
"""Speed below which the motor hands over to the brakes [m/s], as usual for a blended stop."""


def _rolling(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """No dependence on temperature; ``rolling_growth`` is 0 where it is not given."""
    grown = 1.0 + parameters.get("rolling_growth", 0.0) * ((motion.v / _SPEED) ** 2 - 1.0)
    c_rr = parameters["coefficient"] * grown
    return (
        c_rr * motion.load_f * vehicle.front.rolling_radius,
        c_rr * motion.load_r * vehicle.rear.rolling_radius,
    )


def _engine(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """Friction and pumping of an engine grow with its speed; valid for one gear.

    ``drag_growth`` and ``drag_rear_share`` are 0 where they are not given: a car with driven front
    wheels. Negative while the engine or a torque converter still drives the car.
    """
    grown = 1.0 + parameters.get("drag_growth", 0.0) * (motion.v - _SPEED)
    moment, share = parameters["drag_torque"] * grown, parameters.get("drag_rear_share", 0.0)
    return (1.0 - share) * moment, share * moment


def _motor(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """M = min(M_0, P/omega) [N m per axle] from a pressure on, shared by the axles.

    It sets in at ``regen_onset`` and grows with the pressure over ``regen_span``; what the pedal
    asks for it follows with the time constant ``regen_lag``, and its limits at once. omega is that
    of free rolling: P is found too high by the slip of the wheels, 1 to 3 %. Not valid for a motor
    that slows the car without the brake (`engine_drag`).
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


def _flattened(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> dict[str, Array]:
    """The same form as ``radius_load`` of `calib.car.tyre.AxleTyres`, F_z0 the load at rest.

    The torque that goes with the smaller radius, 0.1 to 0.5 % of it, is neglected. Not valid for
    other inflation than at the measurement of the radius.
    """
    q = parameters["radius_load"]
    rest = axle_loads(vehicle, np.zeros(1))
    loads = (motion.load_f, motion.load_r)
    return {
        f"{axle}{side}": np.exp(q * (load / at_rest[0] - 1.0))
        for axle, load, at_rest in zip(AXLES, loads, rest, strict=True)
        for side in "lr"
    }


ROLLING_RESISTANCE = effect(
    "rolling_resistance",
    Parameter("coefficient", "1", 0.0, 0.05, 0.011, 0.005),
    Parameter("rolling_growth", "1", -0.2, 0.5, 0.1, 0.1, default=0.0),
    cause="hysteresis of the rolling tyre",
    equation="M = c_rr (1 + g ((v/20 m/s)^2 - 1)) F_z R, on each wheel; no effect at "
    "coefficient = 0",
    source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 4; SAE J2452",
    looks_like="a deceleration without brake pressure that hardly depends on speed",
    axle_moment=_rolling,
)
EFFECTS = (
    ROLLING_RESISTANCE,
    effect(
        "engine_drag",
        Parameter("drag_torque", "N*m", -500.0, 1500.0, 150.0, 100.0),
        Parameter("drag_growth", "s/m", -0.02, 0.05, 0.008, 0.006, default=0.0),
        Parameter("drag_rear_share", "1", 0.0, 1.0, 0.0, 0.5, default=0.0, share=True),
        cause="engine in gear with closed throttle, at the driven axle or at both",
        equation="M = M_e (1 + g (v - 20 m/s)), 1 - s of it on the front axle, s on the rear "
        "one; no effect at drag_torque = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 2; growth: Heywood, Internal "
        "Combustion Engine Fundamentals, ch. 13",
        looks_like="a nearly constant deceleration, braked or not; the driven axle alone slips",
        axle_moment=_engine,
    ),
    effect(
        "regenerative_torque",
        Parameter("regen_torque", "N*m", 0.0, 3000.0, 170.0, 110.0),
        Parameter("regen_power", "W", 1e3, 200e3, 15e3, 8e3),
        Parameter("regen_rear_share", "1", 0.0, 1.0, 0.5, 0.5, share=True),
        Parameter("regen_onset", "Pa", 0.02e5, 10e5, BITE, 0.5e5, default=BITE),
        Parameter("regen_span", "Pa", 0.1e5, 15e5, 3e5, 3e5, default=_BLEND * BITE),
        Parameter("regen_lag", "s", 0.0, 0.4, 0.03, 0.03, default=0.0),
        cause="an electric motor that brakes an axle, limited by the power it can take",
        equation="M = min(M_0, P/omega) from the pressure p_0 on, in full p_s above it, 1 - s "
        "of it front, s rear; follows the pedal with a lag T; fades out below 3 m/s; no effect "
        "at regen_torque = 0",
        source="Breuer and Bill, Brake Technology Handbook (regenerative braking)",
        looks_like="a deceleration that sets in with the brake, does not grow with pressure "
        "and falls with speed, with slip of the driven axle; at one pressure and speed the "
        "pads absorb it: light and hard stops from high speed show it",
        axle_moment=_motor,
    ),
    effect(
        "wheel_inertia",
        Parameter("extra_inertia", "kg*m^2", 0.0, 10.0, 1.0, 0.7),
        cause="drive shafts, gears and engine that turn with the driven front wheels",
        equation="J_w + J_x at the front; no effect at extra_inertia = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 2 (rotating masses)",
        looks_like="less front tyre force per torque, as with weaker front pads",
        # Valid for one gear: the engine's share grows with the square of the ratio.
        inertia=lambda parameters: (parameters["extra_inertia"], 0.0),
    ),
    effect(
        "rolling_radius_mismatch",
        Parameter("radius_mismatch", "1", -0.03, 0.03, 0.003, 0.003),
        cause="tread wear or inflation that differs between the axles",
        equation="R_r (1 + m); no effect at radius_mismatch = 0",
        source="Pacejka, Tyre and Vehicle Dynamics, ch. 1 (effective rolling radius)",
        looks_like="a constant factor on the rear wheel speeds, braked or not",
        # The front radius is taken as right: a common error is one of the speed scale.
        radius=lambda parameters: (1.0, 1.0 + parameters["radius_mismatch"]),
    ),
    effect(
        "rolling_radius_load",
        Parameter("radius_load", "1", 0.0, 0.03, 0.004, 0.002),
        cause="tyres that are pressed flatter under the load transfer of braking",
        equation="omega exp(q (F_z/F_z0 - 1)); no effect at radius_load = 0",
        source="Pacejka, Tyre and Vehicle Dynamics, ch. 1 (effective rolling radius)",
        looks_like="front wheels that turn faster and rear ones slower in proportion to the "
        "deceleration; pads, tyre stiffness and peak absorb most of it: stops from the same "
        "speed on dry and wet roads, or hard stops beside ramps to the peak, show it",
        wheel_speed=_flattened,
    ),
)
