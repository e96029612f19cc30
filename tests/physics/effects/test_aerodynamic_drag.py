"""Drag against its figure worked out by hand and against the gas law."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.physics.effects.aerodynamic_drag import AIR_DENSITY, EFFECT
from calib.physics.effects.effect import acts_on_wheels
from tests.support.effect_runs import made_motion
from tests.support.tables import VEHICLE


def drag(v, area=0.66, **loads):
    return EFFECT.body_force(VEHICLE, {"drag_area": area}, made_motion(np.atleast_1d(v), **loads))


def test_306_newtons_at_100_km_h():
    assert drag(100.0 / 3.6) == pytest.approx(0.5 * 1.2 * 0.66 * 771.605, rel=1e-6)


def test_density_is_that_of_air_at_20_degrees():
    assert pytest.approx(101325.0 / (287.05 * 293.15), rel=0.005) == AIR_DENSITY


@given(st.floats(0.0, 70.0), st.floats(0.0, 12.0), st.floats(0.0, 1e5))
def test_grows_with_area_and_the_square_of_speed_and_no_load(v, area, load):
    assert drag(2.0 * v, area) == pytest.approx(4.0 * drag(v, area))
    assert drag(v, 2.0 * area) == pytest.approx(2.0 * drag(v, area))
    assert drag(v, area, load_f=load) == drag(v, area)


def test_slows_the_body_and_not_the_wheels():
    speeds = np.array([0.0, 10.0, 30.0])
    assert np.all(np.diff(drag(speeds)) > 0.0)
    assert not acts_on_wheels(EFFECT)
