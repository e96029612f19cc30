"""Stops by road, from stiffnesses that are made."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from calib.estimation.roads import roads_of, stiffness
from tests.estimation.test_metrics import made_estimate
from tests.support.tables import made_table


def stops(*stiffness, sigma=0.04):
    """Stops at 0.3 g on roads whose tyres slip less than those of the ramp by these logarithms."""
    estimate, table = made_estimate(), made_table()
    on_ramp = np.interp(0.3, table.tyre.force, table.tyre.slip) / 0.3
    one = np.ones_like(estimate.time)
    return [
        replace(
            estimate,
            plan=SimpleNamespace(table=table),
            best=replace(
                estimate.best, slip=(np.log(on_ramp) - value) * one, slip_sigma=sigma * one
            ),
        )
        for value in stiffness
    ]


def groups(estimates):
    return [road.stops for road in roads_of(estimates)]


def test_stops_of_different_stiffness_are_of_two_roads():
    assert groups(stops(0.05, -0.22, 0.02, -0.25)) == [(3, 1), (2, 0)]


def test_a_stiffness_is_that_of_the_slip():
    (stop,) = stops(-0.2)
    assert stiffness(stop) == pytest.approx((-0.2, 0.04))


def test_stops_of_one_road_are_rarely_parted():
    rng = np.random.default_rng(3)
    parted = sum(len(groups(stops(*rng.normal(0.0, 0.04, 4)))) > 1 for _ in range(500))
    assert parted < 0.08 * 500


def test_many_stops_do_not_bridge_two_roads():
    between = np.linspace(-0.3, 0.1, 9)
    assert len(groups(stops(*between, sigma=0.02))) > 1
