"""Noise of the channels, and innovations of noise alone, on draws of known size."""

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
    variances = []
    for _ in range(40):
        parts = [rng.standard_normal((len(CHANNELS), 60)) for _ in range(4)]
        noise = noise_of(parts, parts)
        variances.append(noise.sigma**2)
        assert noise.freedom == 4 * (60 - ORDER - 3) - ORDER
    assert np.mean(variances) == pytest.approx(1.0, abs=0.01)  # 40 x 6 draws of 213 degrees: 0.006


def test_white_noise_is_found_in_the_differences_beside_a_bite():
    rng = np.random.default_rng(5)
    sigma = np.array([0.06, 0.02, 0.02, 0.02, 0.03, 0.03])
    bite = np.where(np.arange(240) > 12, 5.0, 0.0)
    whole = bite + sigma[:, None] * rng.normal(size=(6, 240))
    noise = noise_of([whole[:, :4]], [whole])
    assert noise.sigma == pytest.approx(sigma, rel=0.25)
    silent = noise_of([], [np.zeros((6, 240))])
    assert silent.sigma == pytest.approx((0.005, 0.003, 0.005, 0.003, 0.003, 0.003))


def test_the_mean_squared_innovation_of_noise_alone_scatters_as_told():
    """The same runs as a car without any effect and with white noise would have given them."""
    base = based(draw("none", 32, only=("coast", "step_low")))
    problem, rng, excesses = base.problem, np.random.default_rng(8), []
    for _ in range(4):
        runs = []
        for run in problem.runs:
            prediction = predict(problem.vehicle, base.base, Effects(), run)
            a_x = prediction.a_x + 0.04 * rng.standard_normal(run.time.size)
            omega = prediction.omega + 0.02 * rng.standard_normal(prediction.omega.shape)
            runs.append(replace(run, z=-a_x / G, omega=omega))
        fit = fitted(problem_of(problem.vehicle, runs))
        excesses.append((fit.mean_square - 1.0) / fit.scatter)
    assert abs(np.mean(excesses)) < 1.5
    assert 0.3 < np.std(excesses) < 2.0
