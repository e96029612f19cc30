"""Engine drag against Newton's law for the whole car."""

import numpy as np
import pytest

from calib.car.effects.engine_drag import EFFECT
from tests.support.effect_runs import SEDAN, driven, made_motion, without_inertia


def test_the_front_axle_has_all_of_it():
    front, rear = EFFECT.axle_moment(SEDAN, {"drag_torque": 120.0}, made_motion([5.0, 40.0]))
    assert np.array_equal(front, [120.0, 120.0])
    assert np.array_equal(rear, [0.0, 0.0])


def test_a_share_of_it_is_at_the_rear():
    parameters = {"drag_torque": 120.0, "drag_rear_share": 0.75}
    front, rear = EFFECT.axle_moment(SEDAN, parameters, made_motion([5.0, 40.0]))
    assert (front.tolist(), rear.tolist()) == ([30.0, 30.0], [90.0, 90.0])


def test_it_grows_with_the_speed_by_the_share_of_its_parameter():
    grows = {"drag_torque": 100.0, "drag_growth": 0.01}
    front, _ = EFFECT.axle_moment(SEDAN, grows, made_motion([10.0, 20.0, 35.0]))
    assert front == pytest.approx([90.0, 100.0, 115.0])


@pytest.mark.parametrize("torque", [180.0, -60.0])
def test_coasting_in_gear(torque):
    log = driven(
        {"engine_drag": {"drag_torque": torque}}, lambda t: 0.0, car=without_inertia(SEDAN)
    )
    force = torque / SEDAN.front.rolling_radius
    assert log["a_x"] == pytest.approx(-force / SEDAN.mass)
    assert log.truth["true_Fx_fl"] + log.truth["true_Fx_fr"] == pytest.approx(force)
    assert log.truth["true_Fx_rl"] == pytest.approx(0.0, abs=1e-6)
    assert np.all(log.truth["true_Tb_fl"] == 0.0)
