"""Pads and tyres that each log has of its own."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from calib.diagnosis.explanation.base import Ground
from calib.diagnosis.explanation.own_pads import SIGMA, OwnPads
from calib.diagnosis.search.own_pads import follow_a_driver
from calib.diagnosis.written.document import to_dict
from tests.support.explained import diagnosed
from tests.support.hidden.cases import draw


def derivatives(seed, size, channels=1):
    return np.random.default_rng(seed).normal(0.0, 30.0, (channels * size, SIGMA.size))


@given(st.integers(0, 1000), st.integers(3, 12))
def test_innovations_with_own_pads_become_white(seed, size):
    """W (I + J S^2 J') W' = 1, with W read off column by column."""
    J = derivatives(seed, size)
    pads = OwnPads.of(J)
    W = np.stack([pads.whitened([column])[0] for column in np.eye(size)], axis=1)
    covariance = np.eye(size) + J @ np.diag(SIGMA**2) @ J.T
    assert_allclose(W @ covariance @ W.T, np.eye(size), atol=1e-8)


@given(st.integers(0, 1000))
def test_the_channels_of_a_log_stay_apart(seed):
    J = derivatives(seed, 7, channels=2)
    row = np.random.default_rng(seed).standard_normal(14)
    one, two = OwnPads.of(J).whitened([row[:5], row[5:]])
    (whole,) = OwnPads.of(J).whitened([row])
    assert_allclose(np.concatenate([one, two]), whole)
    assert (one.size, two.size) == (5, 9)


@given(st.integers(0, 1000))
def test_the_most_likely_pads_are_those_of_the_normal_equations(seed):
    J, random = derivatives(seed, 40), np.random.default_rng(seed)
    r = random.standard_normal(40)
    d = np.linalg.solve(J.T @ J + np.diag(SIGMA**-2.0), J.T @ r)  # r = J d + noise
    at = Ground(1.1, 0.9, 1.05, 0.8)
    found = OwnPads.of(-J).ground([r], at)  # innovations are measured less predicted
    assert_allclose(found.logarithms - at.logarithms, [*d, 0.0], atol=1e-9)


@pytest.mark.slow
def test_an_effect_is_named_beside_pads_of_each_log():
    """On the independent plant, every run of which has pads and tyres of its own."""
    case = draw("unlike", 3, names=("pad_speed_dependence",), severity=1)
    found = diagnosed(case)
    assert [effect.name for effect in found.effects] == ["pad_speed_dependence"]
    assert found.unexplained is None
    logs = [log.name for log in (*case.calibration, *case.holdout)]
    truth = [np.log(g["pad_scale"]) for g in case.answer["variety"]["grounds"]]
    braked = [i for i, name in enumerate(logs) if not name.startswith("coast")]
    told = [found.own_pads[logs[i]].logarithms[:2] for i in braked]
    off = np.array(told) - np.array(truth)[braked]
    assert_allclose(off - off.mean(axis=0), 0.0, atol=0.02)
    assert to_dict(found)["log_pads"].keys() == set(logs)


def explained_with(pads):
    """Ten logs with other temperatures, and these pads (10, 2) of their own [1]."""
    rng = np.random.default_rng(2)
    runs = [
        SimpleNamespace(
            p_mc=np.full(50, rng.uniform(10e5, 40e5)),
            v_smooth=np.full(50, rng.uniform(10.0, 30.0)),
            temperature_f=np.full(50, temperature),
            temperature_r=None,
        )
        for temperature in np.linspace(80.0, 340.0, 10)
    ]
    grounds = [Ground(*np.exp(own)) for own in pads]
    problem = SimpleNamespace(own_pads=True, runs=runs, grounds=lambda base, effects: grounds)
    return SimpleNamespace(problem=problem, base=None, effects=None)


def test_pads_that_differ_by_chance_follow_nothing():
    rng = np.random.default_rng(1)
    drawn = [explained_with(0.03 * rng.standard_normal((10, 2))) for _ in range(300)]
    assert np.mean([follow_a_driver(one) for one in drawn]) < 0.03


def test_pads_that_follow_the_discs_are_seen():
    """A friction that is 8 % larger where the discs are hot."""
    rng = np.random.default_rng(1)
    hump = 0.08 * np.exp(-(((np.linspace(80.0, 340.0, 10) - 330.0) / 100.0) ** 2))
    seen = [
        follow_a_driver(explained_with(hump[:, None] + 0.01 * rng.standard_normal((10, 2))))
        for _ in range(50)
    ]
    assert np.mean(seen) > 0.9
