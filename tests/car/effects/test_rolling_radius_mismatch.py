"""Radius mismatch: kinematics, and a plant with the same wheels."""

import numpy as np
import pytest

from calib.car.effects.rolling_radius_mismatch import EFFECT
from tests.support.effect_runs import apart, driven, on_the_plant, wave


def test_only_the_rear():
    assert EFFECT.radius({"radius_mismatch": -0.004}) == (1.0, 0.996)


@pytest.mark.parametrize("m", [0.004, -0.01])
def test_rolling_freely_the_rear_turns_slower_on_larger_tyres(m):
    log = driven({"rolling_radius_mismatch": {"radius_mismatch": m}}, lambda t: 0.0)
    assert log["omega_rl"] / log["omega_fl"] == pytest.approx(1.0 / (1.0 + m))


def test_follows_the_plant():
    log = driven({"rolling_radius_mismatch": {"radius_mismatch": -0.004}}, wave)
    run = on_the_plant(wave, radius_scale=(1.0, 0.996))
    assert apart(log, run, "v") < 3e-3
    assert apart(log, run, "omega_rl") < 0.01
    assert np.max(driven({}, wave)["omega_rl"] - run["omega_rl"]) < -0.05
