"""The tyre along the road: when each axle meets a surface."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.model import RELAXATION_LENGTH, Surface, default_model, tyres_along
from tests.support.tables import VEHICLE

TIME = np.arange(401) * 0.01
MODEL = replace(default_model(VEHICLE), surfaces=(Surface(20.0, "m", 0.7, 0.5),))


def test_one_road_is_one_tyre():
    model = default_model(VEHICLE)
    assert tyres_along(model, TIME, 20.0 + 0.0 * TIME) == (model.tyre, model.tyre)


def test_the_rear_axle_meets_it_a_wheelbase_later():
    front, rear = tyres_along(MODEL, TIME, 10.0 + 0.0 * TIME)
    for tyre, behind in ((front, 0.0), (rear, VEHICLE.wheelbase)):
        into = (10.0 * TIME - behind - 20.0) / RELAXATION_LENGTH
        assert np.all(tyre.peak[into < 0.0] == MODEL.tyre.peak)
        assert tyre.peak[into > 1.0] == pytest.approx(0.5 * MODEL.tyre.peak)
        assert tyre.stiffness[into > 1.0] == pytest.approx(0.7 * MODEL.tyre.stiffness)
        inside = (into > 0.0) & (into < 1.0)
        assert np.all(np.diff(tyre.peak[inside]) < 0.0)


def test_a_slowing_car_is_where_its_speed_has_brought_it():
    front, _ = tyres_along(MODEL, TIME, 10.0 - 2.0 * TIME)  # 20 m after 2.76 s
    changed = TIME[np.argmax(front.peak < MODEL.tyre.peak)]
    assert changed == pytest.approx(5.0 - np.sqrt(5.0), abs=0.011)
