"""Effects of the body: forces on it, its mass, and the pitch of its springs.

Drag:   F at the height of the road               load_share = 1: (6) and (7) as in the paper
        F at that of the centre of gravity        load_share = 0: only tyre forces move load
Where F acts, and the lift that comes with it, differ from car to car; a share below 0 or above 1 is
lift at one axle.

Pitch:  z --> body on its springs --> z_b:  z_b'' + 2 D w z_b' + w^2 z_b = w^2 z
        load transfer: (1 - e) z at once through the links, e z_b through the springs
        nose down by e k z_b
The split filter (`calib.estimation.states`) follows the same mode with the same typical values.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car.effects.effect import Parameter, Parameters, effect
from calib.car.history import Motion, RunHistory
from calib.car.lag import second_order
from calib.car.vehicle import Vehicle

AIR_DENSITY = 1.2
"""Density of air at 20 degC and 1013 hPa [kg/m^3], ISO 2533 rounded."""

NATURAL_FREQUENCY = Parameter("natural_frequency", "rad/s", 3.0, 30.0, 2.6 * np.pi, 2.5)
"""1.3 Hz, that of a usual body (Gillespie, ch. 5)."""

DAMPING = Parameter("damping", "1", 0.05, 0.95, 0.3, 0.1)
"""That of a usual body (Gillespie, ch. 5)."""

ELASTIC_SHARE = Parameter("elastic_share", "1", 0.0, 1.5, 0.4, 0.4)
"""Zero on a stiff car, nearly 1 without anti-dive (Gillespie, ch. 7)."""


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


def pitch_deficit(
    vehicle: Vehicle, time: Array, z: Array, natural_frequency: float, damping: float
) -> Array:
    """Share (z - z_b) h/L of W [1] by which load transfer through the springs lags, (n,).

    ``time`` [s], ``z`` deceleration over g [1], (n,); ``natural_frequency`` w [rad/s]; ``damping``
    D [1], 0 <= D < 1. Springs and dampers of both axles as one mode; steady state at the first
    sample. Causal. Not valid where a wheel lifts or the suspension reaches its stops.
    """
    late = z - second_order(time, z, natural_frequency, damping)
    return np.asarray(late * vehicle.cg_height / vehicle.wheelbase)


def _lagging_load(vehicle: Vehicle, parameters: Parameters, history: RunHistory) -> Array:
    w, damping = parameters["natural_frequency"], parameters["damping"]
    return parameters["elastic_share"] * pitch_deficit(vehicle, history.time, history.z, w, damping)


def _nose_down(vehicle: Vehicle, parameters: Parameters, history: RunHistory, a_x: Array) -> Array:
    """Nose down, the reading contains gravity; small angles."""
    frequency, damping = parameters["natural_frequency"], parameters["damping"]
    body = second_order(history.time, history.z, frequency, damping)
    pitch = parameters["elastic_share"] * parameters["pitch_gradient"] * body
    return a_x - G * pitch


AERODYNAMIC_DRAG = effect(
    "aerodynamic_drag",
    Parameter("drag_area", "m^2", 0.0, 12.0, 0.65, 0.25),
    Parameter("load_share", "1", -0.5, 1.5, 0.5, 0.25, default=1.0),
    cause="air resistance of the body",
    equation="F = 1/2 rho (c_d A) v^2, rho = 1.2 kg/m^3; front load less (1 - s) F h/L; no "
    "effect at drag_area = 0",
    source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 1 and 4",
    looks_like="deceleration beyond the tyre forces that falls with v^2, braked or not",
    load_shift=_above_the_road,
    body_force=lambda vehicle, parameters, motion: _drag(parameters, motion.v),
)
EFFECTS = (
    AERODYNAMIC_DRAG,
    effect(
        "mass_error",
        Parameter("mass_error", "1", -0.3, 0.3, 0.05, 0.04),
        cause="passengers, load or fuel other than in the vehicle file",
        equation="M_v (1 + e), in (5) to (7); no effect at mass_error = 0",
        source="Newton's second law; (5) to (7) of the paper",
        looks_like="all brakes weaker by one factor, like a lower pad level; drag has less effect",
        # The centre of gravity stays where it is.
        mass=lambda parameters: 1.0 + parameters["mass_error"],
    ),
    effect(
        "road_grade",
        Parameter("grade", "1", -0.2, 0.2, 0.02, 0.02),
        Parameter("felt", "1", 0.0, 1.0, 0.5, 0.5),
        cause="slope of the road, positive uphill",
        equation="F = W s, s sine of the slope; a_x reads f g s more; no effect at grade = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 1",
        looks_like="a constant deceleration, braked or not, without slip; either sign",
        body_force=_grade,
        accelerometer=_felt,
    ),
    effect(
        "pitch_coupling",
        ELASTIC_SHARE,
        NATURAL_FREQUENCY,
        DAMPING,
        Parameter("pitch_gradient", "rad", 0.0, 0.15, 0.03, 0.015),
        cause="the body pitches on its springs; e of the load transfer goes through them",
        equation="z_b'' + 2 D w z_b' + w^2 z_b = w^2 z; front load less W e (z - z_b) h/L; "
        "a_x - g e k z_b; no effect at elastic_share = 0",
        source="Gillespie, Fundamentals of Vehicle Dynamics, ch. 5 and 7 (anti-dive)",
        looks_like="a_x that oscillates at 1 to 2 Hz after a step and is too large while held",
        load_shift=_lagging_load,
        accelerometer=_nose_down,
    ),
)
