"""The common level against a direct weighted least squares, without lag, with an honest sigma."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calib.estimation.pad_level import estimate_pad_level
from calib.estimation.priors import Priors

PRIORS = Priors()
MEMORY, TREND = PRIORS.level_memory, PRIORS.level_trend
DT, DENSITY = 0.005, 30.0


def braking(n=1200, start=200, seed=1, level=0.8, noise=1.0):
    """A wavering brake force from ``start`` on, and what is demanded of it, [N]."""
    t = DT * np.arange(n)
    nominal = 5000.0 + 2000.0 * np.sin(2.0 * t)
    white = np.random.default_rng(seed).normal(size=n) * DENSITY / np.sqrt(DT)
    return level * nominal + noise * white, nominal, np.arange(n) >= start


def direct(demanded, nominal, active, k, memory=MEMORY):
    """Level and trend at sample k: rows weighed by age, and one row for the prior on the trend."""
    age = DT * np.arange(k, -1, -1)
    root = np.exp(-0.5 * age / memory) * active[: k + 1]
    u = nominal[: k + 1]
    prior = DENSITY / np.sqrt(DT) / TREND
    A = np.vstack([np.column_stack([root * u, -root * u * age]), [0.0, prior]])
    b = np.append(root * demanded[: k + 1], 0.0)
    return np.linalg.lstsq(A, b, rcond=None)[0]


@pytest.mark.parametrize(("k", "memory"), [(200, MEMORY), (230, 0.2), (1199, MEMORY)])
def test_is_the_direct_solve_at_every_instant(k, memory):
    demanded, nominal, active = braking()
    active[700:720] = False
    found = estimate_pad_level(
        DT, demanded, nominal, active, DENSITY, replace(PRIORS, level_memory=memory)
    )
    level, _ = direct(demanded, nominal, active, k, memory)
    assert found.value[k] == pytest.approx(level, rel=1e-9)


def test_nothing_is_known_before_the_brake():
    found = estimate_pad_level(DT, *braking(start=200), DENSITY, PRIORS)
    assert np.all(np.isnan(found.value[:200]))
    assert np.all(np.isnan(found.sigma[:200]))
    assert np.all(np.isfinite(found.value[200:]))


def test_a_drifting_level_is_followed_without_lag():
    t = DT * np.arange(1200)
    level = 0.9 - 0.09 * t
    demanded, nominal, active = braking(level=level, noise=0.0)
    found = estimate_pad_level(DT, demanded, nominal, active, 0.01 * DENSITY, PRIORS)
    assert found.value[400:] == pytest.approx(level[400:], abs=1e-4)
    # a mean with this memory and no trend would be late by 0.09/s x 0.5 s
    weights = np.exp(-t[::-1] / MEMORY)
    assert weights @ level / weights.sum() > level[-1] + 0.04


def test_sigma_is_the_spread_of_200_runs_with_a_steady_level():
    runs = [estimate_pad_level(DT, *braking(seed=seed), DENSITY, PRIORS) for seed in range(200)]
    values = np.array([run.value[[210, 300, 1199]] for run in runs])
    spread = np.std(values, axis=0)
    # 4 sd of a spread of 200, and of a mean
    assert runs[0].sigma[[210, 300, 1199]] == pytest.approx(spread, rel=0.2)
    assert np.all(np.abs(np.mean(values, axis=0) - 0.8) < 4 * spread / 200**0.5)


@pytest.mark.parametrize(("z", "density"), [(0.12, 2e-3), (0.5, 1e-3)])
def test_usual_drift_adds_little_to_sigma(z, density):
    """Drifts drawn with a standard deviation of TREND; ``density`` in g."""
    t = DT * np.arange(700)
    rng = np.random.default_rng(4)
    off = []
    for drift in TREND * rng.normal(size=200):
        level = 0.8 + drift * (t - t[-1])
        demanded = z * level + density / np.sqrt(DT) * rng.normal(size=t.size)
        found = estimate_pad_level(DT, demanded, np.full(t.size, z), t > 1.0, density, PRIORS)
        off.append(
            (found.value[[240, 300, -1]] - level[[240, 300, -1]]) / found.sigma[[240, 300, -1]]
        )
    assert np.sqrt(np.mean(np.square(off), axis=0)) == pytest.approx(np.ones(3), abs=0.35)


@settings(max_examples=30)
@given(st.integers(201, 1199), st.integers(0, 2**31))
def test_knows_nothing_of_the_future(cut, seed):
    demanded, nominal, active = braking()
    other = np.random.default_rng(seed)
    later = np.arange(demanded.size) >= cut
    changed = (
        np.where(later, 1e4 * other.normal(size=later.size), demanded),
        np.where(later, 1e4 * other.random(later.size), nominal),
        np.where(later, other.random(later.size) < 0.5, active),
    )
    before, after = (
        estimate_pad_level(DT, *run, DENSITY, PRIORS)
        for run in ((demanded, nominal, active), changed)
    )
    assert np.array_equal(before.value[:cut], after.value[:cut], equal_nan=True)
    assert np.array_equal(before.sigma[:cut], after.sigma[:cut], equal_nan=True)


@settings(max_examples=15)
@given(st.floats(0.3, 1.5), st.floats(0.1, 10.0))
def test_scales_with_the_pads_and_not_with_the_unit(level, unit):
    demanded, nominal, active = braking(level=level, noise=0.0)
    one = estimate_pad_level(DT, demanded, nominal, active, DENSITY, PRIORS)
    other = estimate_pad_level(DT, unit * demanded, unit * nominal, active, unit * DENSITY, PRIORS)
    assert one.value[200:] == pytest.approx(np.full(1000, level), rel=1e-9)
    assert other.sigma[200:] == pytest.approx(one.sigma[200:], rel=1e-6)
