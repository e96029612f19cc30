"""The level that ramps share: how it moves with the pads' ratio, and what it tells of it."""

from dataclasses import replace

import numpy as np
import pytest

from calib.fitting.identify import identify_once
from calib.fitting.pad_level import level_residuals, level_spread
from calib.model.settings import SETTINGS
from tests.support.reference_car import CAR, IDEAL, noisy, one_axle, prepared, ramp

SHARE = 28.84 * 130.9 / (28.84 * 130.9 + 11.34 * 124.0)
"""Of the front brakes in the force at one pressure, Table I."""

ALIKE = np.full(2, 0.01)


@pytest.fixture(scope="module")
def runs():
    logs = {"n": ramp(IDEAL), "f": one_axle(IDEAL, "f"), "r": one_axle(IDEAL, "r")}
    return {kind: prepared(noisy(log, seed)) for seed, (kind, log) in enumerate(logs.items())}


@pytest.mark.parametrize(("axle", "slope"), [("f", -(1.0 - SHARE)), ("r", SHARE)])
def test_level_of_one_axle_moves_with_the_ratio(runs, axle, slope):
    """ln of its level goes with -+ratio/2, that of both axles with (1/2 - share) ratio."""
    pair = [runs["n"], runs[axle]]
    low, high = (level_residuals(CAR, pair, x, ALIKE) for x in (-0.01, 0.01))
    # two runs lie half of their difference above and below the mean
    apart = np.diff(high - low)[0] * ALIKE[0] / 0.02
    assert apart == pytest.approx(slope, rel=0.01)
    assert level_residuals(CAR, pair, 0.0, ALIKE) == pytest.approx([0.0, 0.0], abs=0.5)


def test_the_common_level_is_the_weighted_mean(runs):
    spread = np.array([0.01, 0.03])
    rest = level_residuals(CAR, [runs["n"], runs["r"]], 0.2, spread)
    assert np.sum(rest / spread) == pytest.approx(0.0, abs=1e-9)
    assert abs(rest[0]) > 0.1


def test_levels_of_normal_ramps_tell_nothing_of_the_ratio(runs):
    """A tenth more pressure for the same forces: pads of another level, and the same answer.

    But for how far the axles' pressures are apart, which is a little less of a higher pressure.
    """
    one, b = runs["n"], runs["n"].blocks
    weaker = replace(one, blocks=replace(b, p_f=1.1 * b.p_f, p_r=1.1 * b.p_r))
    same = identify_once(CAR, [one, one]).posterior
    other = identify_once(CAR, [one, weaker]).posterior
    assert other.mean == pytest.approx(same.mean, abs=1e-3)
    assert np.allclose(other.covariance, same.covariance, rtol=0.02, atol=1e-5)


def test_level_of_one_axle_does(runs):
    one, b = runs["r"], runs["r"].blocks
    weaker = replace(one, blocks=replace(b, p_r=1.1 * b.p_r))
    same, other = (identify_once(CAR, [runs["n"], run]).mean.log_pad_ratio for run in (one, weaker))
    assert other - same > 0.01


def test_spread_is_that_of_the_pads_where_all_else_is_exact(runs):
    found = level_spread(CAR, [runs["n"], runs["f"]], None)
    assert found == pytest.approx([SETTINGS.pads_repeat] * 2)
