"""Grade against the inclined plane."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.names import G
from calib.car.effects.road_grade import EFFECT
from tests.support.effect_runs import SEDAN, driven, made_motion, without_inertia


@given(st.floats(-0.2, 0.2), st.floats(0.0, 60.0))
def test_is_the_weight_along_the_road_at_any_speed(grade, v):
    assert EFFECT.body_force(SEDAN, {"grade": grade}, made_motion([v])) == pytest.approx(
        SEDAN.mass * G * grade
    )


@pytest.mark.parametrize("grade", [0.04, -0.03])
def test_a_car_left_alone_rolls_as_on_an_inclined_plane(grade):
    for felt in (0.0, 1.0):
        effects = {"road_grade": {"grade": grade, "felt": felt}}
        log = driven(effects, lambda t: 0.0, 20.0, car=without_inertia(SEDAN))
        # an accelerometer that feels gravity reads nothing in free rolling
        assert log["a_x"] == pytest.approx((felt - 1.0) * G * grade, abs=1e-9)
    assert log["v"] == pytest.approx(20.0 - G * grade * log.time)
    for w in ("fl", "rr"):
        assert log.truth[f"true_Fx_{w}"] == pytest.approx(0.0, abs=1e-6)
