"""Agreement of stops on one road with like pads, from made-up stiffnesses of the tyres."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.mass import MassUsed
from calib.estimation.agreement import agreement
from calib.estimation.metrics import METRICS
from calib.estimation.validate import HOLDOUT, Validation
from tests.estimation.test_metrics import made_estimate
from tests.support.tables import made_table


def on_road(estimate, stiffness, sigma=0.04):
    """The estimate on a road whose tyres are stiffer than those of the ramp by this logarithm."""
    tyre = made_table().tyre
    ones = np.ones_like(estimate.time)
    slip = np.log(tyre.slip[-1] / tyre.force[-1]) - stiffness
    step = estimate.best.step._replace(slip=slip * ones, slip_sigma=sigma * ones)
    return replace(estimate, table=made_table(), best=replace(estimate.best, step=step))


def stops(*stiffness, sigma=0.04, pads=(0.4, 0.36), level=1.0):
    figures = dict.fromkeys(METRICS) | {"pad_level": level}
    figures |= dict(zip(("pad_friction_f", "pad_friction_r"), pads, strict=True))
    return [
        Validation(
            f"{value:g}", "", HOLDOUT, on_road(made_estimate(), value, sigma), figures, (),
            MassUsed(1744.0, 0.03, False)
        )
        for value in stiffness
    ]  # fmt: skip


def groups(results):
    comparison = agreement(results)
    return None if comparison is None else [road.stops for road in comparison.roads]


def test_stops_of_different_stiffness_are_of_two_roads():
    together = groups(stops(0.05, -0.22, 0.02, -0.25))
    assert together == [("-0.25", "-0.22"), ("0.02", "0.05")]


def test_stops_of_one_road_are_rarely_parted():
    rng = np.random.default_rng(3)
    validation = stops(0.0)[0]
    parted = 0
    for _ in range(300):
        values = rng.normal(0.0, 0.04, 4)
        estimates = [on_road(validation.estimate, x) for x in values]
        comparison = agreement([replace(validation, estimate=e) for e in estimates])
        parted += comparison is None or len(comparison.roads) > 1
    assert parted < 0.08 * 300


def test_the_largest_departure_is_within_a_road():
    together = agreement([
        *stops(0.03, pads=(0.40, 0.40)), *stops(-0.25, pads=(0.20, 0.30)),
        *stops(0.031, pads=(0.42, 0.40)), *stops(-0.24, pads=(0.20, 0.36)),
    ])  # fmt: skip
    assert together.largest_departure_f == pytest.approx(0.01 / 0.41)
    assert together.largest_departure_r == pytest.approx(0.03 / 0.33)
    assert together.pad_friction_f == pytest.approx(1.22 / 4)
    assert together.differ == (0.03 / 0.33 > 0.2)
    assert agreement(stops(0.03, -0.25)) is None


def test_a_wet_stop_is_not_held_against_a_dry_one():
    """The test plan of the paper: pads at half of their friction on the road of the others."""
    dry, again = stops(0.0, 0.01, pads=(0.38, 0.36))
    (wet,) = stops(0.005, pads=(0.19, 0.18), level=0.5)
    assert groups([dry, wet]) is None
    comparison = agreement([dry, wet, again])
    assert (comparison.largest_departure_f, comparison.largest_departure_r) == (0.0, 0.0)
    # pads of one axle that stick, at a level that hardly tells
    (unlike,) = stops(0.005, pads=(0.38, 0.20), level=0.91)
    assert agreement([dry, unlike]).largest_departure_r == pytest.approx(0.08 / 0.28)
