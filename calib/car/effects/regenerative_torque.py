"""Regenerative torque: an electric motor slows an axle while the driver brakes.

M ^  M_0 ________
  |     /        '-.._  P/omega
  |    /
  +---'-----------------> v
"""

import numpy as np

from calib.car.braking import BITE
from calib.car.effects.effect import Card, Effect, Pair, Parameter, Parameters
from calib.car.history import Motion
from calib.car.lag import first_order
from calib.car.vehicle import Vehicle

BLEND = 0.4
"""Range of pressures over which the motor sets in where none is given, over ``regen_onset`` [1]. A
brake light switch closes at one pressure; a motor takes a tenth of a second to build up its torque.
"""

FADE_OUT = 3.0
"""Speed below which the motor hands over to the brakes [m/s], as usual for a blended stop."""


def axle_moment(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Pair:
    """M = min(M_0, P/omega) [N m per axle] from a pressure on, shared by the axles.

    It sets in at ``regen_onset`` and grows with the pressure over ``regen_span``; what the pedal
    asks for it follows with the time constant ``regen_lag``, and its limits at once. omega is that
    of free rolling: P is found too high by the slip of the wheels, 1 to 3 %. Not valid for a motor
    that slows the car without the brake (`engine_drag`). A logged ``T_drive`` counts besides: the
    effect is what the log does not hold.
    """
    share = parameters["regen_rear_share"]
    onset = parameters.get("regen_onset", BITE)
    span = parameters.get("regen_span", BLEND * onset)
    braked = np.clip((motion.history.p_mc - onset) / span, 0.0, 1.0)
    lag = parameters.get("regen_lag", 0.0)
    if lag > 0.0:
        braked = first_order(motion.history.time, braked, lag)
    fading = np.clip(motion.v / FADE_OUT, 0.0, 1.0)
    omega = np.maximum(motion.v, 0.1) / vehicle.front.rolling_radius
    moment = np.minimum(parameters["regen_torque"], parameters["regen_power"] / omega)
    moment = moment * braked * fading
    return (1.0 - share) * moment, share * moment


EFFECT = Effect(
    card=Card(
        name="regenerative_torque",
        cause="an electric motor that brakes an axle, limited by the power it can take",
        equation=(
            "M = min(M_0, P/omega) from the pressure p_0 on, in full p_s above it, 1 - s of it "
            "front, s rear; follows the pedal with a lag T; fades out below 3 m/s; no effect at "
            "regen_torque = 0"
        ),
        source="Breuer and Bill, Brake Technology Handbook (regenerative braking)",
        looks_like=(
            "a deceleration that sets in with the brake, does not grow with pressure and falls "
            "with speed, with slip of the driven axle; at one pressure and speed the pads absorb "
            "it: light and hard stops from high speed show it"
        ),
        parameters=(
            Parameter("regen_torque", "N*m", 0.0, 3000.0, 170.0, 110.0),
            Parameter("regen_power", "W", 1e3, 200e3, 15e3, 8e3),
            Parameter("regen_rear_share", "1", 0.0, 1.0, 0.5, 0.5, share=True),
            Parameter("regen_onset", "Pa", 0.02e5, 10e5, BITE, 0.5e5, default=BITE),
            Parameter("regen_span", "Pa", 0.1e5, 15e5, 3e5, 3e5, default=BLEND * BITE),
            Parameter("regen_lag", "s", 0.0, 0.4, 0.03, 0.03, default=0.0),
        ),
    ),
    axle_moment=axle_moment,
)
