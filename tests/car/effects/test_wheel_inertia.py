"""Driveline inertia: Newton's law for the whole car, and a plant with heavier wheels."""

from dataclasses import replace

import pytest

from calib.car.effects.wheel_inertia import EFFECT
from tests.support.effect_runs import SEDAN, apart, driven, on_the_plant, wave


def test_only_the_front():
    assert EFFECT.inertia({"extra_inertia": 1.5}) == (1.5, 0.0)


def test_a_constant_brake_has_more_to_slow():
    """a = -sum(T_b/R)/(M + sum J/R^2), but for the change of slip."""
    log = driven({"wheel_inertia": {"extra_inertia": 4.0}})
    R, J = SEDAN.front.rolling_radius, SEDAN.front.wheel_inertia + SEDAN.rear.wheel_inertia
    brakes = 2.0 * (log.truth["true_Tb_fl"] + log.truth["true_Tb_rl"]) / R
    heavy = SEDAN.mass + 2.0 * (J + 4.0) / R**2
    assert SEDAN.rear.rolling_radius == R
    assert log["a_x"][100:] == pytest.approx(-brakes[100:] / heavy, rel=2e-3)


def test_follows_the_plant_with_heavier_wheels():
    heavy = replace(SEDAN, front=replace(SEDAN.front, wheel_inertia=1.2 + 1.5))
    assert SEDAN.front.wheel_inertia == 1.2
    log = driven({"wheel_inertia": {"extra_inertia": 1.5}}, wave)
    run = on_the_plant(wave, car=heavy)
    assert apart(log, run, "v") < 5e-3
    assert apart(log, run, "omega_fl") < 0.02
