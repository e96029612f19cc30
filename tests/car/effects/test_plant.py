"""Effects of the simulation against an independent plant that has each effect by other means."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from tests.support.effect_runs import SEDAN, apart, clock, driven, on_the_plant, wave

HEAT = {"f": 110.0 + 40.0 * clock(4.0), "r": np.full(801, 60.0)}
HEAVY = replace(SEDAN, front=replace(SEDAN.front, wheel_inertia=SEDAN.front.wheel_inertia + 1.5))
PITCH = {
    "elastic_share": 1.0,
    "natural_frequency": 2.0 * np.pi * 1.5,
    "damping": 0.25,
    "pitch_gradient": 0.03,
}


def ramp(t):
    return 6e5 * t


def swinging(t, T=0.08, D=0.4):
    """Return p of T^2 p'' + 2 D T p' + p = ramp."""
    w = np.sqrt(1.0 - D * D) / T
    swing = 2 * D * T * np.cos(w * t) + T * (2 * D * D - 1) / np.sqrt(1 - D * D) * np.sin(w * t)
    return 6e5 * (t - 2 * D * T + np.exp(-D * t / T) * swing)


def valve(t):
    return min(wave(t), 15e5) + 0.4 * max(wave(t) - 15e5, 0.0)


def up_and_down(t):
    return 6e5 * min(t, 4.0 - t)  # up to 12 bar and back in 4 s


def in_the_play(t):
    return max(6e5 * t - 1e5, 0.0) if t < 2.0 else min(11e5, 6e5 * (4.0 - t) + 1e5)


def released(t):
    return 20e5 * min(max(11.0 - 5.0 * t, 0.0), 1.0)  # from 2 to 2.2 s


def stuck(t):
    return released(t) if t < 2.18 else 2e5 * np.exp(-(t - 2.18) / 5.0)


def step(t):
    return min(max(t - 1.0, 0.0) * 250e5, 25e5)


def faded(t):
    return 0.38 * (1.0 - 0.001 * 40.0 * max(t - 1.0, 0.0)), SEDAN.rear.pad_friction


class Case(NamedTuple):
    parameters: dict[str, float]  # of the effect
    pedal: Callable[[float], float]  # pressure of the simulation [Pa] over time [s]
    pressure: Callable[[float], float]  # pressure of the plant [Pa], which has the effect
    plant: dict[str, object]  # further options of the plant
    agree: dict[str, float]  # channels that agree, each with its tolerance
    without: tuple[str, float]  # a channel, and its least difference without the effect


CASES = {
    "hydraulic_delay": Case({"delay": 0.08}, wave, lambda t: wave(max(t - 0.08, 0.0)), {},
        {"v": 3e-3, "true_Tb_fl": 0.9}, ("v", 0.05)),
    "hydraulic_lag": Case({"time_constant": 0.15}, ramp,
        lambda t: 6e5 * (t - 0.15 * (1.0 - np.exp(-t / 0.15))), {},
        {"v": 2e-3, "true_Tb_fl": 1e-3}, ("v", 0.2)),
    "hydraulic_oscillation": Case({"response_time": 0.08, "line_damping": 0.4}, ramp, swinging, {},
        {"v": 2e-3, "true_Tb_fl": 1e-3}, ("v", 0.05)),
    "rear_proportioning": Case({"knee_slope": 0.4, "knee": 15e5}, wave, wave,
        {"wheel_pressure": {"rl": valve, "rr": valve}},
        {"true_Tb_rr": 1e-6, "omega_rl": 0.01, "v": 3e-3}, ("v", 0.05)),
    "caliper_hysteresis": Case({"width": 0.1, "fixed_share": 1.0}, up_and_down, in_the_play, {},
        {"v": 3e-3}, ("v", 0.05)),
    "residual_torque": Case({"residual_pressure": 2e5, "drain_time": 5.0, "rear_bias": 1.0},
        released, released, {"wheel_pressure": {"rl": stuck, "rr": stuck}}, {"v": 5e-3},
        ("v", 0.1)),
    "pad_thermal_fade": Case({"fade_slope": 0.001, "fade_onset": 150.0}, lambda t: 25e5,
        lambda t: 25e5, {"pads": faded},
        {"true_Tb_fl": 1e-6, "true_mu_pad_f": 1e-12, "v": 2e-3}, ("v", 0.2)),
    "side_imbalance": Case({"imbalance": 0.1, "rear_share": 0.0}, wave, wave,
        {"wheel_pressure": {"fl": lambda t: 1.1 * wave(t), "fr": lambda t: 0.9 * wave(t)}},
        {"omega_fl": 0.01, "omega_fr": 0.01, "omega_rl": 0.01}, ("omega_fl", 0.05)),
    "wheel_inertia": Case({"extra_inertia": 1.5}, wave, wave, {"car": HEAVY},
        {"v": 5e-3, "omega_fl": 0.02}, ("v", 0.05)),
    "rolling_radius_mismatch": Case({"radius_mismatch": -0.004}, wave, wave,
        {"radius_scale": (1.0, 0.996)}, {"v": 3e-3, "omega_rl": 0.01}, ("omega_rl", 0.05)),
    "mass_error": Case({"mass_error": 0.1}, wave, wave, {"mass_scale": 1.1},
        {"v": 3e-3, "true_Fz_fl": 5.0}, ("v", 0.3)),
    "pitch_coupling": Case(PITCH, step, step, {"pitch_frequency": 1.5, "pitch_damping": 0.25},
        {"true_Fz_fl": 10.0, "v": 5e-3}, ("true_Fz_fl", 200.0)),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_the_simulation_follows_the_plant(name):
    case = CASES[name]
    heat = {"temperature": HEAT} if name == "pad_thermal_fade" else {}
    log = driven({name: case.parameters}, case.pedal, **heat)
    run = on_the_plant(case.pressure, **case.plant)
    assert {channel: apart(log, run, channel) for channel in case.agree} == {
        channel: pytest.approx(0.0, abs=tolerance) for channel, tolerance in case.agree.items()
    }
    changed, least_change = case.without
    assert apart(driven({}, case.pedal), run, changed) > least_change
