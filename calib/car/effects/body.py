"""Effects of the body: forces on it, its mass, the pitch of its springs; and of the sensors.

Drag:   F at the height of the road               load_share = 1: (6) and (7) as in the paper
        F at that of the centre of gravity        load_share = 0: only tyre forces move load
Where F acts, and the lift that comes with it, differ from car to car; a share below 0 or above 1 is
lift at one axle.

Pitch:  z --> body on its springs --> z_b:  z_b'' + 2 D w z_b' + w^2 z_b = w^2 z
        load transfer: (1 - e) z at once through the links, e z_b through the springs
        nose down by e k z_b
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car.effects.effect import Parameters, effect
from calib.car.history import Motion, RunHistory
from calib.car.lag import second_order
from calib.car.vehicle import Vehicle

AIR_DENSITY = 1.2
"""Density of air at 20 degC and 1013 hPa [kg/m^3], ISO 2533 rounded."""


def _drag(parameters: Parameters, v: Array) -> Array:
    """1/2 rho c_d A v^2 [N]; still air, standard density."""
    return np.asarray(0.5 * AIR_DENSITY * parameters["drag_area"] * v**2)


def _above_the_road(vehicle: Vehicle, parameters: Parameters, history: RunHistory) -> Array:
    """(1 - s) F h/(W L): what (6) has too much if F does not act at the road."""
    less = 1.0 - parameters.get("load_share", 1.0)
    lever = vehicle.cg_height / (vehicle.weight * vehicle.wheelbase)
    return less * lever * _drag(parameters, history.v)


def _grade(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> Array:
    """Constant over the run, loads of a flat road; the sine is within 0.5 % of 10 % of grade."""
    return np.full_like(motion.v, vehicle.weight * parameters["grade"])


def _felt(vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array) -> Array:
    """A sensor reads specific force (f = 1), a log may hold dv/dt."""
    return a_x + parameters["felt"] * G * parameters["grade"]


def _lagging_load(vehicle: Vehicle, parameters: Parameters, history: RunHistory) -> Array:
    """Share e (z - z_b) h/L of W [1] by which load transfer through the springs lags, (n,).

    A usual body has 1.3 Hz and a damping of 0.3 (Gillespie, ch. 5); the elastic share is zero on a
    stiff car, nearly 1 without anti-dive (ch. 7). Springs and dampers of both axles as one mode;
    steady state at the first sample. Not valid where a wheel lifts or the suspension reaches its
    stops.
    """
    late = history.z - _body_mode(parameters, history)
    return np.asarray(parameters["elastic_share"] * late * vehicle.cg_height / vehicle.wheelbase)


def _body_mode(parameters: Parameters, history: RunHistory) -> Array:
    """z_b [1] (n,)."""
    frequency, damping = parameters["natural_frequency"], parameters["damping"]
    return second_order(history.time, history.z, frequency, damping)


def _nose_down(vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array) -> Array:
    """Nose down, the reading contains gravity; small angles."""
    share = parameters["elastic_share"] * parameters["pitch_gradient"]
    return a_x - G * (share * _body_mode(parameters, history))


def _filtered(parameters: Parameters) -> tuple[float, float]:
    """T, and q T^2; q, ``filter_bend``, is 0 where it is not given: first order.

    A filter of a higher order is close to one of second order with the same delay.
    """
    T = parameters["filter_time"]
    return T, parameters.get("filter_bend", 0.0) * T**2


def _off_centre(vehicle: Vehicle, parameters: Parameters, motion: Motion) -> dict[str, Array]:
    """``runout_side`` is 1 when only the left ring runs out, -1 only the right one, 0 both in step.

    The angle counts from the first sample, unless its origin was set by the ripple of the run: low
    where a disc of uneven thickness would slow the wheel. Not valid for a ring with a damaged
    tooth: that is a spike once a turn.
    """
    a, side = parameters["runout"], parameters["runout_side"]
    turned = a * motion.history.ripple(parameters["runout_phase"])
    left, right = min(1.0, 1.0 + side), min(1.0, 1.0 - side)
    return {"fl": 1.0 - left * turned, "fr": 1.0 - right * turned}


AERODYNAMIC_DRAG = effect(
    "aerodynamic_drag",
    load_shift=_above_the_road,
    body_force=lambda vehicle, parameters, motion: _drag(parameters, motion.v),
)
EFFECTS = (
    AERODYNAMIC_DRAG,
    # The centre of gravity stays where it is.
    effect("mass_error", mass=lambda parameters: 1.0 + parameters["mass_error"]),
    effect("road_grade", body_force=_grade, accelerometer=_felt),
    effect("pitch_coupling", load_shift=_lagging_load, accelerometer=_nose_down),
    # Sensors: the car moves as without them.
    effect(
        "accelerometer_scale",
        accelerometer=lambda vehicle, own, history, a_x: a_x * (1.0 + own["scale_error"]),
    ),
    effect(
        "accelerometer_bias",
        accelerometer=lambda vehicle, own, history, a_x: a_x + own["bias"],
    ),
    effect("accelerometer_lag", accelerometer_lag=_filtered),
    effect("speed_delay", speed_delay=lambda parameters: parameters["v_delay"]),
    effect("wheel_speed_delay", wheel_speed_delay=lambda parameters: parameters["omega_delay"]),
    effect("tone_ring_runout", wheel_speed=_off_centre),
)
