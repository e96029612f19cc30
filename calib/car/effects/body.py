"""Effects of the body (drag, grade, mass, pitch) and of the sensors.

Air drag F transfers load between the axles according to the height at which F acts:

    at the road                     load_share = 1     load transfer (6), (7) as in the paper
    at the centre of gravity        load_share = 0     only tyre forces transfer load

A share outside 0 to 1 adds a pitching moment. Net lift is not modelled.

Pitch: the body on its springs follows the deceleration z with a mode of frequency w and damping D:

    z_b'' + 2 D w z_b' + w^2 z_b = w^2 z

The elastic share e of the load transfer goes through the springs and follows z_b, the deceleration
of the body; the links of the suspension transfer the rest at once. The nose goes down by the angle
e k z_b, k the pitch gradient [rad].
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car.effects.effect import Parameters, effect, sides
from calib.car.history import Motion, RunHistory
from calib.car.lag import second_order
from calib.car.vehicle import Vehicle

AIR_DENSITY = 1.2  # density of air at 20 degC and 1013 hPa [kg/m^3], rounded


def _drag(parameters: Parameters, v: Array) -> Array:
    """1/2 rho c_d A v^2 [N]; still air, standard density."""
    return np.asarray(0.5 * AIR_DENSITY * parameters["drag_area"] * v**2)


def _drag_load(vehicle: Vehicle, parameters: Parameters, history: RunHistory) -> Array:
    """(1 - s) F h/(W L) [1]: by this share of W, (6) is too large; s is the ``load_share``."""
    share = parameters.get("load_share", 1.0)
    transfer_per_force = vehicle.cg_height / (vehicle.weight * vehicle.wheelbase)  # h/(W L) [1/N]
    return (1.0 - share) * transfer_per_force * _drag(parameters, history.v)


def _grade(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
    """W times the grade [N], constant over the run; the grade is the sine of the slope."""
    return np.full_like(motion.v, vehicle.weight * parameters["grade"])


def _on_grade(vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array) -> Array:
    """Reading of a_x: ``felt`` is 1 for a sensor, 0 for an a_x that was computed from a speed."""
    return a_x + parameters["felt"] * G * parameters["grade"]


def _lagging_load(vehicle: Vehicle, parameters: Parameters, history: RunHistory) -> Array:
    """e (z - z_b) h/L [1] (n,), the load transfer over W that the springs have not yet made.

    A usual body has 1.3 Hz and a damping of 0.3 (Gillespie, ch. 5). The elastic share e is 0 on a
    stiff car and nearly 1 without anti-dive (ch. 7). The body is in steady state at the first
    sample. Not valid where a wheel lifts or the suspension reaches its stops.
    """
    lag = history.z - _body_mode(parameters, history)
    return np.asarray(parameters["elastic_share"] * lag * vehicle.cg_height / vehicle.wheelbase)


def _body_mode(parameters: Parameters, history: RunHistory) -> Array:
    """Deceleration z_b of the body [1] (n,)."""
    frequency, damping = parameters["natural_frequency"], parameters["damping"]
    return second_order(history.time, history.z, frequency, damping)


def _pitched(vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array) -> Array:
    """Reading of an a_x sensor that pitches with the body, and so feels gravity; small angles."""
    angle_per_z = parameters["elastic_share"] * parameters["pitch_gradient"]  # e k [rad]
    return a_x - G * (angle_per_z * _body_mode(parameters, history))


def _filter(parameters: Parameters) -> tuple[float, float]:
    """T [s] and S = q T^2 [s^2] of the lag of a_x, see `Effect`; q is ``filter_bend``, or 0."""
    T = parameters["filter_time"]
    return T, parameters.get("filter_bend", 0.0) * T**2


def _scaled(vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array) -> Array:
    return a_x * (1.0 + parameters["scale_error"])


def _biased(vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array) -> Array:
    return a_x + parameters["bias"]


def _runout(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> dict[str, Array]:
    """Factors [1] on the front wheel speeds from the runout of their tone rings, one wave a turn.

    Both rings are in step, or one is alone, see `sides`. The phase is that of `RunHistory.ripple`.
    Not valid for a damaged tooth, which gives a spike.
    """
    wave = parameters["runout"] * motion.history.ripple(parameters["runout_phase"])
    left, right = sides(parameters["runout_side"])
    return {"fl": 1.0 - left * wave, "fr": 1.0 - right * wave}


AERODYNAMIC_DRAG = effect(
    "aerodynamic_drag",
    load_shift=_drag_load,
    body_force=lambda vehicle, parameters, motion: _drag(parameters, motion.v),
)
EFFECTS = (
    AERODYNAMIC_DRAG,
    # the centre of gravity stays where it is
    effect("mass_error", mass=lambda parameters: 1.0 + parameters["mass_error"]),
    effect("road_grade", body_force=_grade, accelerometer=_on_grade),
    effect("pitch_coupling", load_shift=_lagging_load, accelerometer=_pitched),
    # effects of sensors, which do not change the motion of the car
    effect("accelerometer_scale", accelerometer=_scaled),
    effect("accelerometer_bias", accelerometer=_biased),
    effect("accelerometer_lag", accelerometer_lag=_filter),
    effect("speed_delay", speed_delay=lambda parameters: parameters["v_delay"]),
    effect("wheel_speed_delay", wheel_speed_delay=lambda parameters: parameters["omega_delay"]),
    effect("tone_ring_runout", wheel_speed=_runout),
)
