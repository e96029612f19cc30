"""Noise of the channels of evidence, and innovations of noise alone, on draws of known size."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.channels import CHANNELS, ORDER, noise_of
from calib.diagnosis.explanation.predict import predict
from calib.diagnosis.explanation.problem import problem_of
from tests.support.explained import based, fitted
from tests.support.hidden.cases import draw


def test_the_noise_of_a_channel_is_unbiased_however_short_its_parts():
    rng = np.random.default_rng(3)
    found = []
    for _ in range(40):
        parts = [rng.standard_normal((len(CHANNELS), 60)) for _ in range(4)]
        noise = noise_of(parts, parts)
        found.append(noise.sigma**2)
        assert noise.freedom == 4 * (60 - ORDER - 3) - ORDER
    assert np.mean(found) == pytest.approx(1.0, abs=0.01)  # 40 x 6 draws of 213 degrees: 0.006


def test_white_noise_is_found_in_the_differences_beside_a_bite():
    rng = np.random.default_rng(5)
    sigma = np.array([0.06, 0.02, 0.02, 0.02, 0.03, 0.03])
    bite = np.where(np.arange(240) > 12, 5.0, 0.0)
    whole = bite + sigma[:, None] * rng.normal(size=(6, 240))
    found = noise_of([whole[:, :4]], [whole])
    assert found.sigma == pytest.approx(sigma, rel=0.25)
    silent = noise_of([], [np.zeros((6, 240))])
    assert silent.sigma == pytest.approx((0.005, 0.003, 0.005, 0.003, 0.003, 0.003))


def test_the_mean_squared_innovation_of_noise_alone_scatters_as_told():
    """The same runs as a car without any effect and with white noise would have given them."""
    base = based(draw("none", 32, only=("coast", "step_low")))
    problem, rng, drawn = base.problem, np.random.default_rng(8), []
    for _ in range(4):
        runs = []
        for run in problem.runs:
            made = predict(problem.vehicle, base.base, Effects(), run)
            a_x = made.a_x + 0.04 * rng.standard_normal(run.time.size)
            omega = made.omega + 0.02 * rng.standard_normal(made.omega.shape)
            runs.append(replace(run, z=-a_x / G, omega=omega))
        at = fitted(problem_of(problem.vehicle, runs))
        drawn.append((at.mean_square - 1.0) / at.scatter)
    assert abs(np.mean(drawn)) < 1.5
    assert 0.3 < np.std(drawn) < 2.0
