"""The plant of the tests against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.support.cornering import GRAVITY
from tests.support.plant import Plant, drive
from tests.support.reference_car import CAR, IDEAL

COASTING = {"duration": 2.0, "rate": 100.0}


def no_pressure(t: float) -> float:
    return 0.0


def test_a_slope_slows_the_car_and_the_accelerometer_does_not_see_it():
    run = drive(replace(IDEAL, grade=0.03), no_pressure, 25.0, **COASTING)
    inertia = sum(2 * a.wheel_inertia / a.rolling_radius**2 for a in (CAR.front, CAR.rear))
    slowed = GRAVITY * 0.03 / (1.0 + inertia / CAR.mass)
    assert run["v"][-1] == pytest.approx(25.0 - 2.0 * slowed, abs=1e-3)
    # what the wheels' inertia pushes is all that it feels
    assert run["a_x"][100] == pytest.approx(GRAVITY * 0.03 - slowed, abs=1e-3)


def test_a_motor_gives_what_its_share_leaves_it_at_a_speed():
    plant = replace(IDEAL, motor=lambda t: (-160.0, 0.0), motor_share=lambda v: 0.01 * v)
    run = drive(plant, no_pressure, 25.0, **COASTING)
    assert run["T_drive_f"] == pytest.approx(-1.6 * run["v"])
    assert run["T_drive_r"] == pytest.approx(np.zeros_like(run["v"]))
    inertia = sum(2 * a.wheel_inertia / a.rolling_radius**2 for a in (CAR.front, CAR.rear))
    rate = 1.6 / CAR.front.rolling_radius / (CAR.mass + inertia)
    assert run["v"][-1] == pytest.approx(25.0 * math.exp(-rate * run["time"][-1]), rel=1e-4)


def test_pitch_tilts_the_accelerometer():
    dip = math.radians(2.0)
    braked = [
        drive(plant, lambda t: 20e5, 25.0, **COASTING)
        for plant in (IDEAL, replace(IDEAL, pitch_felt=dip))
    ]
    z = -braked[0]["a_x"] / GRAVITY
    felt = -braked[1]["a_x"] / GRAVITY
    assert felt == pytest.approx(z * np.cos(dip * z) + np.sin(dip * z), abs=1e-9)
    assert felt[50] / z[50] == pytest.approx(1.0 + dip, abs=1e-3)


def test_a_tyre_builds_up_its_force_over_its_relaxation():
    """F = 25 lambda', and lambda = lambda' + (sigma/v) d lambda'/dt of the wheel speed."""
    way = 0.4
    straight = replace(IDEAL, relaxation=way, tyre=lambda slip, load, *_: 25.0 * slip)
    rise = lambda t: 40e5 * min(max((t - 0.5) / 0.5, 0.0), 1.0)  # noqa: E731
    run = drive(straight, rise, 25.0, duration=1.5, rate=1000.0)
    carried = run["true_Fx_rl"] / run["true_Fz_rl"] / 25.0
    slip = 1.0 - CAR.rear.rolling_radius * run["omega_rl"] / run["v"]
    built = carried + way / run["v"] * np.gradient(carried, run["time"])
    inside = (run["time"] > 0.55) & (run["time"] < 0.95)
    assert slip[inside] == pytest.approx(built[inside], rel=1e-3)
    assert np.max(slip[inside] / carried[inside]) > 1.05


def test_the_brakes_lag_and_the_log_does_not():
    late = replace(IDEAL, hydraulic_lag=0.2)
    run = drive(late, lambda t: 20e5 if t > 0.5 else 0.0, 25.0, **COASTING)
    at = int(np.searchsorted(run["time"], 0.7))
    assert run["p_mc"][at] == 20e5
    full = run["true_Tb_fl"][-1]
    assert run["true_Tb_fl"][at] == pytest.approx(full * (1.0 - math.exp(-1.0)), rel=0.02)


def test_a_bend_turns_the_wheels_on_their_own_paths():
    curvature, v = 1.0 / 200.0, 20.0
    plant = Plant(CAR, curvature=lambda t: curvature)
    run = drive(plant, no_pressure, v, duration=0.5, rate=100.0)
    omega = {w: run[f"omega_{w}"][20] for w in ("fl", "fr", "rl", "rr")}
    behind = 0.5 * curvature * CAR.track_width
    assert omega["rr"] / omega["rl"] == pytest.approx((1 + behind) / (1 - behind), rel=1e-4)
    assert omega["fl"] > omega["rl"]
    load = {w: run[f"true_Fz_{w}"][20] for w in omega}
    moved = 2.0 * CAR.cg_height / CAR.track_width * curvature * run["v"][20] ** 2 / GRAVITY
    assert load["fr"] / load["fl"] == pytest.approx((1 + moved) / (1 - moved), rel=1e-6)


def test_a_tyre_that_corners_pulls_less_along_the_car():
    straight = Plant(CAR)
    bent = replace(straight, curvature=lambda t: 1.0 / 150.0)
    a, b = (drive(p, lambda t: 20e5, 25.0, duration=1.0, rate=100.0) for p in (straight, bent))
    slip = [1.0 - CAR.rear.rolling_radius * 0.5 * (run["omega_rl"] + run["omega_rr"]) / run["v"]
            for run in (a, b)]  # fmt: skip
    assert slip[1][80] > slip[0][80]


def test_a_locked_wheel_stands_and_does_not_turn_backwards():
    run = drive(IDEAL, lambda t: 300e5 * min(t, 1.0), 20.0, duration=2.0, rate=100.0)
    assert run["omega_fl"][-1] == pytest.approx(0.0, abs=0.2)
    assert min(run[f"omega_{w}"].min() for w in ("fl", "fr", "rl", "rr")) > -0.01
    assert run["v"][-1] > 2.0


def test_hills_are_the_slope_of_the_way():
    """What a coasting car loses in speed is what it gains in height: v^2/2 + g h."""
    hilly = replace(IDEAL, hills=lambda x: 0.02 * math.sin(x / 30.0))
    run = drive(hilly, no_pressure, 25.0, **COASTING)
    way = np.concatenate([[0.0], np.cumsum(0.5 * (run["v"][1:] + run["v"][:-1]) / 100.0)])
    height = 0.02 * 30.0 * (1.0 - np.cos(way / 30.0))
    assert 0.5 * run["v"] ** 2 + GRAVITY * height == pytest.approx(0.5 * 25.0**2, rel=2e-3)
    assert np.max(np.abs(run["a_x"])) < 0.02  # the wheels alone push
