"""Mass: the same brakes on a heavier car."""

import numpy as np
import pytest

from calib.car.effects.mass_error import EFFECT
from tests.support.effect_runs import SEDAN, apart, driven, on_the_plant, wave, without_inertia


def test_the_factor():
    assert EFFECT.mass({"mass_error": -0.08}) == pytest.approx(0.92)


def test_without_inertia_deceleration_goes_with_one_over_the_mass():
    car = without_inertia(SEDAN)
    log, light = driven({"mass_error": {"mass_error": 0.1}}, car=car), driven({}, car=car)
    n = min(log.time.size, light.time.size)
    assert log["a_x"][:n] == pytest.approx(light["a_x"][:n] / 1.1)
    total = sum(log.truth[f"true_Fz_{w}"] for w in ("fl", "fr", "rl", "rr"))
    assert total == pytest.approx(1.1 * SEDAN.weight)


def test_rolling_and_grade_go_with_the_weight_and_drag_does_not():
    car, heavier = without_inertia(SEDAN), {"mass_error": {"mass_error": 0.2}}
    grade = {
        "road_grade": {"grade": 0.05, "felt": 0.0},
        "rolling_resistance": {"coefficient": 0.012},
    }
    drag = {"aerodynamic_drag": {"drag_area": 0.7}}

    def first(effects):
        return driven(effects, lambda t: 0.0, car=car)["a_x"][0]

    assert first(heavier | grade) == pytest.approx(first(grade))
    assert first(heavier | drag) == pytest.approx(first(drag) / 1.2)


def test_follows_the_plant():
    log = driven({"mass_error": {"mass_error": 0.1}}, wave)
    run = on_the_plant(wave, mass_scale=1.1)
    assert apart(log, run, "v") < 3e-3
    assert apart(log, run, "true_Fz_fl") < 5.0
    assert np.max(np.abs(driven({}, wave)["v"] - run["v"])) > 0.3
