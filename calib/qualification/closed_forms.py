"""Checks of single functions against closed forms; the expected values use no code of `calib`."""

import numpy as np

from calib import units
from calib.estimation import adaptive
from calib.physics import forces
from calib.qualification.check import Check
from calib.qualification.material import Material
from calib.statistics import random_effects

CAR = "simulation_study/vehicle.toml"
EXACT = 1e-9
"""Relative tolerance of a closed form: far above rounding (1e-16 an operation), far below any
error of a formula."""

# Tables I and II of the paper: mass, centre of gravity, front brake.
M, L_F, L_R, H, G = 1744.0, 1.1556, 1.6494, 0.615, 9.80665
Z, PRESSURE = 0.5, 50e5

TORQUE = 2.0 * 0.40 * 28.84e-4 * 0.1309 * PRESSURE
LOAD = M * G * (L_R + Z * H) / (L_F + L_R)
ADAPTED = 0.08 * (1.0 - 0.99**500)
"""theta after 500 steps that each leave 0.99 of the error, towards 0.08."""

THINGS = np.array([[0.36], [0.39], [0.40], [0.45]])
BETWEEN = 0.0014 - 0.0001
"""Sample variance of `THINGS`, 0.0042/3, less their own variance of 0.01^2: what the maximum of
the restricted likelihood is where all own variances are equal."""


def _torque(material: Material) -> float:
    front = material.vehicle(CAR).front
    return float(forces.brake_torque(front, front.pad_friction, np.array([PRESSURE]))[0])


def _load(material: Material) -> float:
    return float(forces.axle_loads(material.vehicle(CAR), np.array([Z]))[0][0])


def _constraint(material: Material) -> float:
    """Largest |f1 F_zf + f2 F_zr| over weight, with loads from the balance of moments."""
    z, D = np.linspace(0.0, 0.9, 10), np.linspace(-0.1, 0.1, 10)
    f1, f2 = forces.paper_curves(material.vehicle(CAR), z, D)
    front = (L_R + z * H) / (L_F + L_R)
    return float(np.max(np.abs(f1 * front + f2 * (1.0 - front))) + np.max(np.abs(f1 - f2 - D)))


def _adapted(material: Material) -> float:
    u = np.full(500, -200.0)
    gamma, dt = 0.01 / (200.0**2 * 0.005), 0.005
    return float(adaptive.gradient(0.08 * u, u, gamma, dt)[-1])


def _psi(material: Material) -> float:
    return float(units.to_si(100.0, "psi", "Pa"))


def _between(material: Material) -> float:
    own = np.full(THINGS.shape, 0.01**2)
    return float(random_effects.random_effects(THINGS, own).between[0])


CHECKS = (
    Check(
        "unit_psi", "100 psi", "Pa", 100.0 * 0.45359237 * G / 0.0254**2, 1e-3,
        "definition of pound, inch and standard gravity", _psi,
    ),
    Check(
        "brake_torque", "front brake torque of one wheel at 50 bar, (2) and (3)", "N*m",
        TORQUE, EXACT * TORQUE, "closed form with Tables I and II of the paper", _torque,
    ),
    Check(
        "axle_load", "load of the front axle at 0.5 g, (6)", "N", LOAD, EXACT * LOAD,
        "balance of moments with Tables I and II of the paper", _load,
    ),
    Check(
        "constraint", "largest violation of (18) and of D = f1 - f2", "1", 0.0, EXACT,
        "equation (18) of the paper", _constraint,
    ),
    Check(
        "adaptive_law", "theta of (25) after 500 equal steps", "1", ADAPTED, EXACT,
        "closed form: a geometric series", _adapted,
    ),
    Check(
        "spread_of_cars", "variance between four cars measured alike", "1", BETWEEN, 1e-3 * BETWEEN,
        "closed form: sample variance less own variance", _between,
    ),
)  # fmt: skip
