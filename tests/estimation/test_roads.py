"""Stops by road, from stiffnesses that are made."""

from dataclasses import replace

import numpy as np

from calib.estimation.roads import roads_of
from tests.estimation.test_metrics import made_estimate


def stops(*stiffness, sigma=0.04, changes=()):
    estimate = made_estimate()
    return [
        replace(
            estimate,
            split=replace(
                estimate.split,
                changes=changes if value is None else (),
                log_stiffness=np.array([0.0, value or 0.0]),
                log_stiffness_sigma=np.array([1.0, sigma]),
            ),
        )
        for value in stiffness
    ]


def groups(estimates):
    return [road.stops for road in roads_of(estimates)]


def test_stops_of_different_stiffness_are_of_two_roads():
    assert groups(stops(0.05, -0.22, 0.02, -0.25)) == [(3, 1), (2, 0)]


def test_a_stop_over_a_change_of_surface_is_alone():
    found = roads_of(stops(0.0, None, 0.01, changes=(3.0,)))
    assert [(road.stops, road.one) for road in found] == [((0, 2), True), ((1,), False)]


def test_stops_of_one_road_are_rarely_parted():
    rng = np.random.default_rng(3)
    parted = sum(len(groups(stops(*rng.normal(0.0, 0.04, 4)))) > 1 for _ in range(500))
    assert parted < 0.08 * 500


def test_many_stops_do_not_bridge_two_roads():
    between = np.linspace(-0.3, 0.1, 9)
    assert len(groups(stops(*between, sigma=0.02))) > 1
