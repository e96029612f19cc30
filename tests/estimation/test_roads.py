"""Stops by road, from stiffnesses that are made."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from calib.estimation.roads import roads_of, stiffness
from tests.estimation.test_metrics import made_estimate
from tests.support.tables import made_table


def on_road(estimate, stiffness, sigma=0.04):
    """The estimate on a road whose tyres are stiffer than those of the ramp by this logarithm."""
    tyre = made_table().tyre
    one = np.ones_like(estimate.time)
    slip = np.log(tyre.slip[-1] / tyre.force[-1]) - stiffness
    told = replace(estimate.best, slip=slip * one, slip_sigma=sigma * one)
    return replace(estimate, plan=SimpleNamespace(table=made_table()), best=told)


def stops(*stiffness, sigma=0.04):
    return [on_road(made_estimate(), value, sigma) for value in stiffness]


def groups(estimates):
    return [road.stops for road in roads_of(estimates)]


def test_stops_of_different_stiffness_are_of_two_roads():
    assert groups(stops(0.05, -0.22, 0.02, -0.25)) == [(3, 1), (2, 0)]


def test_a_stiffness_is_that_of_the_slip():
    (stop,) = stops(-0.2)
    told = np.array(stiffness(stop))
    assert told == pytest.approx(np.array([-0.2, 0.04]))


def test_stops_of_one_road_are_rarely_parted():
    rng = np.random.default_rng(3)
    parted = sum(len(groups(stops(*rng.normal(0.0, 0.04, 4)))) > 1 for _ in range(500))
    assert parted < 0.08 * 500


def test_many_stops_do_not_bridge_two_roads():
    between = np.linspace(-0.3, 0.1, 9)
    assert len(groups(stops(*between, sigma=0.02))) > 1
