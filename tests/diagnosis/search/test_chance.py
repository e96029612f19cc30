"""Chance on the user's own logs, against innovations that are drawn and have no effect in them."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.channels import CHANNELS, ORDER, noise_of, whiten
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.search.chance import chance_of
from calib.diagnosis.search.search import hints
from tests.support.explained import based
from tests.support.hidden.cases import draw


def redrawn(problem, base, rng):
    """The same runs as a car without any effect and with white noise would have given them."""
    runs = []
    for run in problem.runs:
        made = predict(problem.vehicle, base, Effects(), run)
        runs.append(
            replace(
                run,
                a_x=made.a_x + 0.04 * rng.standard_normal(run.time.size),
                omega=made.omega + 0.02 * rng.standard_normal(made.omega.shape),
            )
        )
    return problem_of(problem.vehicle, runs)


def test_few_cars_without_an_effect_show_more_than_chance_gives():
    base = based(draw("none", 31, only=("coast", "ramp", "step_low")))
    rng, ratios = np.random.default_rng(5), []
    for _ in range(6):
        drawn = redrawn(base.problem, base.base, rng)
        at = fit(drawn, (), base.x)
        chance = chance_of(at, at)
        ratios.append(max(hint.gain / chance[hint.name] for hint in hints(at)))
    # one in a hundred is meant to be above 1: two of six have a probability below 0.2 %
    assert sum(ratio > 1.0 for ratio in ratios) <= 1
    # and chance is no loose bound: it is reached in part by each of them
    assert np.median(ratios) > 0.25


def test_an_effect_that_is_there_gains_more_than_chance_and_does_not_count_as_noise():
    base = based(draw("single", 9, names=("hydraulic_lag",), severity=0, only=("coast", "ramp")))
    first = hints(base)[0]
    best = fit(base.problem, (first.name,), first.start)
    with_it, without = chance_of(base, base), chance_of(base, best)
    assert base.chi2 - best.chi2 > 10.0 * without[first.name]
    assert without[first.name] < with_it[first.name]


def test_the_noise_of_a_channel_is_unbiased_however_short_its_parts():
    rng = np.random.default_rng(3)
    found = []
    for _ in range(40):
        parts = [rng.standard_normal((len(CHANNELS), 60)) for _ in range(4)]
        noise = noise_of(parts, parts)
        found.append(noise.sigma**2)
        assert noise.freedom == 4 * (60 - ORDER - 3) - ORDER
    assert np.mean(found) == pytest.approx(1.0, abs=0.01)  # 40 x 6 draws of 213 degrees: 0.006


def test_the_mean_squared_innovation_of_noise_alone_scatters_as_told():
    base = based(draw("none", 32, only=("coast", "ramp", "step_low", "hot")))
    rng = np.random.default_rng(8)
    drawn = []
    for _ in range(8):
        at = fit(redrawn(base.problem, base.base, rng), (), base.x)
        drawn.append((at.reduced - 1.0) / at.scatter)
    assert abs(np.mean(drawn)) < 1.5
    assert 0.3 < np.std(drawn) < 2.0


def test_whitened_noise_is_white():
    rng = np.random.default_rng(2)
    parts = [rng.standard_normal((len(CHANNELS), 4000))]
    for channel in whiten(parts[0], noise_of(parts, parts))[2:]:
        assert np.mean(channel**2) == pytest.approx(1.0, abs=0.07)
