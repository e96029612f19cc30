"""Drag against its figure worked out by hand and against the gas law."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.names import WHEELS, G
from calib.car.balance import force_balance
from calib.car.effects.aerodynamic_drag import AIR_DENSITY, EFFECT
from calib.car.effects.effect import acts_on_wheels
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads
from calib.car.model import default_model
from calib.model.simulate import simulate
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


def shift(v, share):
    motion = made_motion(np.atleast_1d(v))
    return EFFECT.load_shift(VEHICLE, {"drag_area": 0.66, **share}, motion.history)


def test_at_the_height_of_the_road_it_moves_load_as_the_paper_has_it():
    assert shift(30.0, {}) == 0.0
    assert shift(30.0, {"load_share": 1.0}) == 0.0


def test_at_the_height_of_the_centre_of_gravity_only_tyre_forces_move_load():
    """Moments about the contact of the rear wheels: F_zf L = W l_r + F_x h."""
    model = default_model(
        replace(VEHICLE, effects=Effects({"aerodynamic_drag": {"drag_area": 2, "load_share": 0.0}}))
    )
    time = np.arange(400) / 200.0
    run = simulate(model, time, 10e5 * np.minimum(time, 1.0), 40.0)
    F_x = sum(run.truth[f"true_Fx_{w}"] for w in WHEELS)
    moment = VEHICLE.weight * VEHICLE.cg_to_rear_axle + F_x * VEHICLE.cg_height
    F_zf = run.truth["true_Fz_fl"] + run.truth["true_Fz_fr"]
    assert F_zf == pytest.approx(moment / VEHICLE.wheelbase, rel=1e-6)
    z = -run["a_x"] / G
    assert np.all(axle_loads(VEHICLE, z)[0] > 1.01 * F_zf)


def test_a_known_share_is_in_the_loads_of_an_estimate():
    known = Effects({"aerodynamic_drag": {"drag_area": 0.66, "load_share": 0.0}})
    z, v = np.array([0.3]), np.array([30.0])
    found = force_balance(VEHICLE, known, np.zeros(1), v, z, np.array([20e5]))
    assert found.load_f == pytest.approx(axle_loads(VEHICLE, found.tyre_sum / VEHICLE.weight)[0])


def test_slows_the_body_and_not_the_wheels():
    speeds = np.array([0.0, 10.0, 30.0])
    assert np.all(np.diff(drag(speeds)) > 0.0)
    assert not acts_on_wheels(EFFECT)
