"""The weights of a zero that ages, against what noise and walk leave of a mean."""

import numpy as np
import pytest

from calib.run.noise import WALK, aged

STEP = 0.05


def weights(density, duration):
    time = STEP * np.arange(round(duration / STEP))
    factor = aged(time, np.ones(time.size, bool), np.full(time.size, density))
    return factor**-2.0


def variance(w, density):
    """Of the weighed mean about the last value, from white noise and the walk since each sample."""
    share = w / w.sum()
    noise = density**2 / STEP * share @ share
    older = np.cumsum(share)[:-1]  # what each step of the walk misses
    return noise + WALK**2 * STEP * older @ older


@pytest.mark.parametrize("duration", [40.0, 300.0])
def test_the_variance_is_that_of_the_steady_kalman_filter(duration):
    density = 5e-5
    w = weights(density, duration)
    claimed = density**2 / STEP / w.sum()
    assert variance(w, density) == pytest.approx(density * WALK, rel=0.05)
    assert claimed == pytest.approx(density * WALK, rel=0.05)
    assert variance(w, density) < variance(np.ones(w.size), density)


def test_a_lead_in_much_shorter_than_it_lasts_is_a_plain_mean():
    w = weights(1e-3, 1.0)  # tau is 80 s
    assert w.min() > 0.9


def test_what_does_not_roll_keeps_its_sigma():
    time, rolling = np.arange(4.0), np.array([True, True, False, False])
    factor = aged(time, rolling, np.full(4, WALK))
    assert factor == pytest.approx([np.exp(0.5), 1.0, 1.0, 1.0])
    assert aged(time, np.zeros(4, bool), np.full(4, WALK)) == pytest.approx(np.ones(4))
