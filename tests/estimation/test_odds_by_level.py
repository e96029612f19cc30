"""The factor against drawn pads: how often the ratio was kept, of those with such a level."""

import numpy as np
import pytest

from calib.estimation.odds_by_level import odds_by_level
from calib.estimation.priors import Priors

P = Priors()
FRONT, ERROR = 0.7, 0.02


def drawn(count):
    """Measured level, and whether the ratio was kept, of pads as the docstring has them."""
    rng = np.random.default_rng(5)
    kind = rng.choice(5, count, p=[0.25, 0.25, 0.125, 0.125, 0.25])
    spread = [P.level_alike, P.level_free, FRONT * P.ratio, (1.0 - FRONT) * P.ratio, P.level_free]
    level = rng.normal(0.0, np.array(spread)[kind]) + rng.normal(0.0, ERROR, count)
    return level, kind < 2


@pytest.mark.parametrize("at", [0.0, 0.12])
def test_factor_is_the_odds_among_pads_with_this_level(at):
    level, kept = drawn(2_000_000)
    near = np.abs(level - at) < 0.004
    odds = np.sum(kept[near]) / np.sum(~kept[near])
    (factor,) = odds_by_level(np.array([at]), np.array([ERROR]), FRONT, P)
    assert factor == pytest.approx(odds, rel=0.1)


def test_a_level_that_is_not_known_says_nothing():
    assert odds_by_level(np.array([np.nan]), np.array([np.nan]), FRONT, P) == 1.0
