"""Tyre, pads and zeros of plant ramps come back, and the stated sigmas are honest."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize

from calib.fitting.identify import identify, identify_once
from calib.model.parameters import RampParameters
from calib.model.ramp import sigma_eta, sigma_slip
from calib.model.settings import SETTINGS
from calib.run.noise import SensorNoise
from tests.support.plant import magic
from tests.support.reference_car import (
    CAR,
    IDEAL,
    noisy,
    prepared,
    ramp,
    with_pads,
    with_ratio,
    without,
)

SEEDS = range(3)
PLANTS = {
    "as nominal": IDEAL,
    "front 15 % better": with_ratio(IDEAL, 1.15),
    "rear 15 % better": with_ratio(IDEAL, 1.0 / 1.15),
}


def found(*logs):
    return identify(CAR, [prepared(log) for log in logs])[0]


def sigmas(answer):
    """Standard deviation of each parameter, by name."""
    return RampParameters(*(answer.posterior.sigma(name) for name in RampParameters._fields))


def off(answer, before):
    """How far the parameters moved, over their sigma before."""
    return np.abs(np.subtract(answer.mean, before.mean)) / sigmas(before)


@pytest.fixture(scope="module")
def clean():
    return {name: ramp(plant) for name, plant in PLANTS.items()}


@pytest.fixture(scope="module")
def three(clean):
    """Three runs of one car, each with its own noise, ready to fit."""
    return [prepared(noisy(clean["as nominal"], seed)) for seed in range(3)]


@pytest.mark.parametrize(
    ("name", "log_ratio", "dropped"),
    [("front 15 % better", math.log(1.15), ()), ("rear 15 % better", -math.log(1.15), ("v",))],
)
def test_compliance_and_pads_are_found_within_their_sigmas(clean, name, log_ratio, dropped):
    answers = [found(without(noisy(clean[name], seed), *dropped)) for seed in SEEDS]
    truth = {"log_compliance": math.log(1.0 / 25.0), "log_pad_ratio": log_ratio}
    z = np.array(
        [
            (a.posterior.value(name) - value) / a.posterior.sigma(name)
            for a in answers
            for name, value in truth.items()
        ]
    )
    assert np.max(np.abs(z)) < 3.0
    assert np.sqrt(np.mean(z**2)) < 1.5
    # (2) is exact in the plant: the sum of forces fixes the level, at any ratio, to its weight
    for a in answers:
        off = 0.5 * abs(a.mean.log_pad_ratio - log_ratio)
        assert a.pad_scale[0] == pytest.approx(1.0, abs=0.005 + off)


def test_pads_and_tyres_that_differ_imitate_each_other(clean):
    """Eta shows share over stiffness of each axle: more pads in front, or softer tyres there."""
    posterior = found(noisy(clean["rear 15 % better"], 0)).posterior
    i, j = (posterior.names.index(n) for n in ("log_pad_ratio", "log_tyre_ratio"))
    both = posterior.covariance[i][j]
    assert both < -0.5 * posterior.sigma("log_pad_ratio") * posterior.sigma("log_tyre_ratio")
    assert posterior.sigma("log_pad_ratio") > 0.03


@pytest.mark.parametrize("scale", [0.7, 1.2])
def test_level_of_the_pads_is_found(scale):
    mu = scale * CAR.front.pad_friction
    log = noisy(ramp(with_pads(IDEAL, mu, mu), slope=5e5 / scale), 3)
    assert found(log).pad_scale[0] == pytest.approx(scale, rel=0.005)


def test_curvature_has_the_sign_of_the_tyre(clean):
    """A saturating tyre takes more slip per force the more it carries; a straight one does not."""
    straight = ramp(replace(IDEAL, tyre=magic(25.0, 50.0)))
    for seed in SEEDS:
        growth = []
        for log in (clean["as nominal"], straight):
            t = found(noisy(log, seed)).posterior.tyre
            slip = t.slip(np.array([0.1, 0.5]), 1.0)
            growth.append(slip[1] / (5.0 * slip[0]) - 1.0)
        assert growth[0] > 0.05  # the plant's own: 0.13
        assert abs(growth[1]) < growth[0] - 0.05


def test_slip_at_a_force_is_that_of_the_plant(clean):
    tyre = magic(25.0, 0.9)
    for force in (0.1, 0.3, 0.5):
        truth = scipy.optimize.brentq(lambda s, F=force: tyre(s, 1.0, 1.0, 1.0) - F, 0.0, 0.05)
        slips = [
            found(noisy(clean["as nominal"], s)).posterior.tyre.slip(np.asarray(force), 1.0)
            for s in SEEDS
        ]
        assert np.mean(slips) == pytest.approx(truth, rel=0.05)


def test_zeros_are_the_radii(clean):
    """Eta is omega_r/omega_f, so a rear wheel that is larger turns slower."""
    larger = ramp(replace(IDEAL, radius_scale=(1.002, 1.003)))
    answer = found(larger)
    assert answer.eta_zero[0] == pytest.approx(1.002 / 1.003 - 1.0, abs=3e-5)
    # the mean slip is computed with nominal radii: too large by the load-weighted mismatch
    share = 1.6494 / 2.805
    mean = share * 0.002 + (1.0 - share) * 0.003
    assert answer.slip_zero[0] == pytest.approx(mean, abs=1e-4)
    assert found(clean["as nominal"]).eta_zero[0] == pytest.approx(0.0, abs=3e-5)


def test_more_ramps_tighten_every_sigma(three):
    one, two, all_three = (sigmas(identify_once(CAR, three[:n])) for n in (1, 2, 3))
    # where two hypotheses are weighed a run may shift the weights, and widen what they span
    for name in RampParameters._fields[:5]:
        assert getattr(all_three, name) < getattr(two, name) < getattr(one, name)
    # noise and model error are independent between blocks: 1/sqrt(3), less what the prior held
    for name in ("log_compliance", "curvature_2", "curvature_3"):
        assert getattr(all_three, name) < 0.75 * getattr(one, name)


def test_huber_resists_a_burst_that_plain_squares_do_not(clean, monkeypatch):
    log = noisy(clean["as nominal"], 1)
    burst = 1.0 + 0.01 * ((log.time > 5.0) & (log.time < 5.3))  # 40 sigma of a block
    hit = {f"omega_r{side}": log[f"omega_r{side}"] * burst for side in "lr"}
    runs = [prepared(log)], [prepared(replace(log, channels={**log.channels, **hit}))]
    before = identify_once(CAR, runs[0])
    robust = off(identify_once(CAR, runs[1]), before)
    assert np.max(robust) < 1.5

    real = scipy.optimize.least_squares

    def plain(*arguments, **keywords):
        return real(*arguments, **{**keywords, "loss": "linear"})

    monkeypatch.setattr(scipy.optimize, "least_squares", plain)
    squares = off(identify_once(CAR, runs[1]), before)
    assert np.max(squares) > 5.0 * np.max(robust)


def test_noise_that_the_sensors_did_not_show_widens_the_sigmas(clean):
    """Both wheels of the rear axle shaken alike: left minus right sees nothing of it."""
    log = noisy(clean["as nominal"], 0)
    rough = (
        1.0
        + 1e-3
        * np.repeat(np.random.default_rng(5).standard_normal(log.time.size // 100 + 1), 100)[
            : log.time.size
        ]
    )
    shaken = {f"omega_r{side}": log[f"omega_r{side}"] * rough for side in "lr"}
    answer, louder = identify(CAR, [prepared(replace(log, channels={**log.channels, **shaken}))])
    assert louder[0].noise.omega > 2.0 * prepared(log).noise.omega
    sigma = sigmas(answer).log_compliance
    assert abs(answer.mean.log_compliance - math.log(1 / 25)) < 3.0 * sigma
    assert sigma > 1.5 * sigmas(found(log)).log_compliance


def test_sigmas_of_a_block_without_slip_are_those_of_its_sensors(clean):
    run = replace(
        prepared(clean["as nominal"]),
        noise=SensorNoise(omega=0.01, z=0.0, v=0.02, omega_white=0.0),
    )
    b, still = run.blocks, np.zeros(run.blocks.end.size)
    # a mean over T has the density over sqrt(T); eta is a ratio of two of them
    # after the lead-in, whose samples age
    one, after = 0.01 / math.sqrt(0.05) / b.omega_f, ~b.lead_in
    assert sigma_eta(run, still)[after] == pytest.approx(math.sqrt(2.0) * one[after])
    v = 0.02 / math.sqrt(0.05) / b.speed
    assert sigma_slip(run, still)[after] == pytest.approx(np.hypot(one, v)[after])
    rising = sigma_eta(run, still + 0.01)[run.use]
    assert np.all(rising > sigma_eta(run, still)[run.use])
    assert rising[-1] > 2.0 * rising[0]  # near the peak the curve is known less


def test_each_run_has_its_own_zeros_and_level(clean):
    other = ramp(replace(with_pads(IDEAL, 0.36, 0.36), radius_scale=(1.0, 1.002)))
    answer = found(noisy(clean["as nominal"], 0), noisy(other, 1))
    assert answer.eta_zero == pytest.approx((0.0, 1.0 / 1.002 - 1.0), abs=2e-4)
    assert answer.pad_scale == pytest.approx((1.0, 0.36 / 0.38), rel=0.005)


def test_a_ratio_that_clearly_differs_is_not_called_nominal(clean):
    """15 % may be the tyres, which differ by 10 %; 50 % is 4 sigma of that and of noise."""
    for ratio in (1.5, 1.0 / 1.5):
        assert found(noisy(ramp(with_ratio(IDEAL, ratio)), 0)).nominal_weight < 0.05
    assert found(noisy(clean["as nominal"], 0)).nominal_weight > 1.0 - SETTINGS.pads_differ


def test_without_v_the_stiffness_stays_open(clean):
    log = noisy(clean["front 15 % better"], 0)
    blind, seeing = sigmas(found(without(log, "v"))), sigmas(found(log))
    assert blind.log_compliance > 2.0 * seeing.log_compliance
