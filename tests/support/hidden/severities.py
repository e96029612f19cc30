"""How strong each hidden effect is drawn: three severities, from modest to strong.

A range (low, high) is cut in three; a severity draws evenly within its third. A range in double
brackets has either sign.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tests.support.hidden.settings import Hidden

Strength = Callable[[float, float], float]
"""Ends of the range -> the value drawn in the third that the severity names."""

Draw = Callable[[Strength, np.random.Generator], dict[str, float]]

SEVERITIES = 3


def hide(hidden: Hidden, name: str, severity: int, rng: np.random.Generator) -> Hidden:
    """Add the effect ``name`` with ``severity`` 0, 1 or 2."""

    def strength(low: float, high: float) -> float:
        part = (severity + rng.uniform()) / SEVERITIES
        return float(low + part * (high - low))

    return replace(hidden, **(CATALOGUE | OUTSIDE | ABSORBED)[name](strength, rng))


def sign(rng: np.random.Generator) -> float:
    """Plus or minus one."""
    return float(rng.choice([-1.0, 1.0]))


def fade(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """Above 150 to 200 degC."""
    return {"fade": s(0.0008, 0.002), "fade_onset": float(rng.uniform(150.0, 200.0))}


def wet(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """Dry after a few seconds of braking."""
    return {"wet_loss": s(0.15, 0.4), "dry_energy": float(rng.uniform(30e3, 90e3))}


def grade(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """Up or down. Logs are made with both kinds of a_x: specific force, and dv/dt."""
    return {"grade": sign(rng) * s(0.005, 0.025), "grade_felt": bool(rng.random() < 0.5)}


def imbalance(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """In front alone, or on both axles alike."""
    return {"imbalance": sign(rng) * s(0.04, 0.10), "imbalance_rear": float(rng.integers(2))}


def thickness(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """Both front discs in step, or the left alone."""
    return {"thickness": s(0.02, 0.06), "thickness_right": float(rng.integers(2))}


def pitch(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """A softer body dives further."""
    return {
        "pitch_frequency": float(rng.uniform(1.1, 1.6)),
        "pitch_damping": float(rng.uniform(0.2, 0.4)),
        "pitch_gain": s(0.02, 0.06),
    }


def hysteresis(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """A width that grows with the pressure, or a fixed one."""
    if rng.random() < 0.5:
        return {"hysteresis": s(0.08, 0.20)}
    return {"hysteresis_fixed": s(0.8e5, 2.0e5)}


def line(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """A throttle, or a throttle and a soft hose behind it."""
    lag = s(0.08, 0.25)
    return {"lag": lag, "lag_behind": float(rng.integers(2) * rng.uniform(0.2, 0.6) * lag)}


def regeneration(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """On either axle, limited by power from some 20 m/s on; at once, or with an inverter's lag."""
    return {
        "regen_torque": s(60.0, 160.0),
        "regen_power": float(rng.uniform(4e3, 10e3)),
        "regen_axle": int(rng.integers(2)),
        "regen_lag": float(rng.integers(2) * rng.uniform(0.02, 0.08)),
    }


def slosh(s: Strength, rng: np.random.Generator) -> dict[str, float]:
    """A tank that is half full."""
    return {"slosh_mass": s(0.03, 0.08), "slosh_frequency": float(rng.uniform(0.5, 0.9))}


CATALOGUE: dict[str, Draw] = {
    "aerodynamic_drag": lambda s, r: {"drag_area": s(0.5, 0.8)},
    "rolling_resistance": lambda s, r: {"rolling": s(0.008, 0.02)},
    "road_grade": grade,
    "engine_drag": lambda s, r: {"engine_torque": s(60.0, 200.0)},
    "pad_thermal_fade": fade,
    "pad_speed_dependence": lambda s, r: {"speed_slope": -s(0.003, 0.008)},
    "pad_pressure_dependence": lambda s, r: {"pressure_slope": -s(0.003e-5, 0.008e-5)},
    "wet_pad_recovery": wet,
    "rolling_radius_mismatch": lambda s, r: {"radius_mismatch": sign(r) * s(0.002, 0.006)},
    "brake_threshold_pressure": lambda s, r: {"threshold": s(1e5, 3e5)},
    "hydraulic_lag": line,
    "hydraulic_delay": lambda s, r: {"delay": s(0.05, 0.15)},
    "rear_proportioning": lambda s, r: {
        "knee": float(r.uniform(10e5, 20e5)),
        "knee_slope": 0.9 - s(0.3, 0.6),
    },
    "caliper_hysteresis": hysteresis,
    "pitch_coupling": pitch,
    "accelerometer_bias": lambda s, r: {"bias": sign(r) * s(0.08, 0.25)},
    "accelerometer_scale": lambda s, r: {"scale_error": sign(r) * s(0.03, 0.08)},
    "wheel_inertia": lambda s, r: {"inertia": s(1.0, 3.0)},
    "side_imbalance": imbalance,
    "disc_thickness_variation": thickness,
    "mass_error": lambda s, r: {"mass_error": sign(r) * s(0.03, 0.08)},
    "residual_torque": lambda s, r: {"sticking": s(1.5e5, 5e5)},
    "hydraulic_oscillation": lambda s, r: {
        "surge": 4.0 - s(0.8, 2.8),
        "surge_damping": float(r.uniform(0.2, 0.5)),
    },
    "regenerative_torque": regeneration,
    "rolling_radius_load": lambda s, r: {"radius_load": s(0.003, 0.012)},
    "tone_ring_runout": lambda s, r: {"tooth_error": s(0.0006, 0.002)},
    "accelerometer_lag": lambda s, r: {"filter_frequency": 16.0 - s(1.0, 11.0)},
    "speed_delay": lambda s, r: {"v_late": s(0.03, 0.15)},
    "wheel_speed_delay": lambda s, r: {"wheel_window": s(0.03, 0.08)},
}

OUTSIDE: dict[str, Draw] = {
    "abs_modulation": lambda s, r: {"abs_slip": 0.024 - s(0.004, 0.012)},
    "stiffness_over_speed": lambda s, r: {"stiffness_speed": sign(r) * s(0.006, 0.018)},
    "tyre_warming": lambda s, r: {"stiffness_heat": s(0.25e-6, 0.6e-6)},
    "tank_slosh": slosh,
    "weaker_applications": lambda s, r: {"weaker_by": s(0.05, 0.12)},
    "seized_wheel": lambda s, r: {"seized": s(50.0, 150.0)},
}

ABSORBED: dict[str, Draw] = {
    "anti_dive": lambda s, r: pitch(s, r) | {"through_springs": float(r.uniform(0.3, 0.8))},
}
"""What has no name of its own, but a parameter of another one. Drawn only by name."""
