"""Informative priors narrow the posterior, but never against the ramps."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from calib.base.warning import Measured, rule_warnings
from calib.car.tyre_file import read_tyres
from calib.fitting import prior as module
from calib.fitting.ensemble import draws_of
from calib.fitting.pads import DEFAULT_PRIOR
from calib.fitting.posterior import posterior
from calib.fitting.prior import Prior, informative_priors, log_importance
from calib.table.table import Calibration, Value
from tests.support.plant import magic
from tests.support.reference_car import CAR, IDEAL, noisy, prepared, ramp, with_ratio, without
from tests.support.tyre_files import written

RATIO, STIFFNESS, SIZE = 1.08, 25.0, 14
FIELD = Prior("all cars", "tyre_file", np.zeros(SIZE), np.eye(SIZE))
SHARP = np.eye(SIZE)
SHARP[8, 8] = 0.2**2  # of the pads' ratio


def plant(stiffness=STIFFNESS, ratio=RATIO):
    return replace(with_ratio(IDEAL, ratio), tyre=magic(stiffness, 0.9))


@pytest.fixture(scope="module")
def run():
    return prepared(without(noisy(ramp(plant()), 1), "v"))


@pytest.fixture(scope="module")
def alone(run):
    return posterior(CAR, [run], DEFAULT_PRIOR)


@pytest.fixture(scope="module")
def tyre(tmp_path_factory):
    """The tyre file of the plant, its stiffness times a factor."""
    folder = tmp_path_factory.mktemp("tyres")

    def read(factor=1.0):
        path = folder / f"tyre_{factor}.tir"
        load = 0.25 * CAR.weight
        return read_tyres([written(path, FNOMIN=load, PKX1=factor * STIFFNESS)])[0]

    return read


def inside(x, true, share=0.95):
    low, high = np.quantile(x, [0.5 - 0.5 * share, 0.5 + 0.5 * share])
    return low < true < high


def contradicted(priors, support):
    """Return the warnings of priors that the ramps contradict."""
    pairs = zip(priors, support, strict=True)
    return rule_warnings("car", [Measured(prior.code, p) for prior, p in pairs])


def test_to_know_the_field_is_to_know_nothing(run, alone):
    """Even odds stay even, and the answer is that of the ramp."""
    e = posterior(CAR, [run], DEFAULT_PRIOR, priors=(FIELD,))
    assert e.prior_support == pytest.approx(0.5, abs=0.06)
    twice = posterior(CAR, [run], DEFAULT_PRIOR, priors=(FIELD, FIELD))
    assert twice.prior_support == pytest.approx(0.5, abs=0.08)
    for name in ("log_pad_ratio", "compliance_f", "load_exponent", "radius_load"):
        x, expected = getattr(e, name), getattr(alone, name)
        assert np.mean(x) == pytest.approx(np.mean(expected), abs=0.15 * np.std(expected))
        assert np.std(x) == pytest.approx(np.std(expected), rel=0.12)


@pytest.mark.parametrize("by_user", [Value(0.0, 0.02), Value(0.1, 0.01), Value(0.05, 0.12)])
def test_a_stated_ratio_takes_the_place_of_the_prior_of_the_field(by_user):
    """The density of the field, pads of a grade and a tenth 4.3 times as far, cancels."""
    r = np.linspace(-1.5, 1.5, 30_001)
    field = 0.9 * norm.pdf(r, 0.0, 0.07) + 0.1 * norm.pdf(r, 0.0, 4.3 * 0.07)
    density = norm.logpdf(r, by_user.value, by_user.sigma)
    assert np.ptp(np.log(field) + log_importance(by_user, r) - density) < 1e-9


def test_a_stated_ratio_multiplies_what_is_known(run):
    """A prior that agrees, with a fifth of the default sigma, gets 0.83 by normal densities."""
    for mean, low, high in ((0.6, 0.75, 0.9), (-3.0, 0.0, 0.01)):
        prior = replace(
            FIELD, mean=np.eye(SIZE)[module.PLACES["log_pad_ratio"][0]] * mean, covariance=SHARP
        )
        e = posterior(CAR, [run], Value(0.04, 0.01), priors=(prior,))
        assert np.mean(e.log_pad_ratio) == pytest.approx(0.04, abs=0.004)
        assert low < e.prior_support[0] < high


def test_the_right_tyre_file_narrows(run, alone, tyre):
    e = posterior(CAR, [run], DEFAULT_PRIOR, priors=informative_priors(CAR, [tyre()], {}))
    assert e.prior_support[0] > 0.6
    assert np.std(np.log(e.compliance_f)) < 0.9 * np.std(np.log(alone.compliance_f))
    for estimate, true in (
        (e.log_pad_ratio, math.log(RATIO)),
        (e.compliance_f, 1.0 / STIFFNESS),
        (e.compliance_r, 1.0 / STIFFNESS),
    ):
        assert inside(estimate, true)
    assert not contradicted(informative_priors(CAR, [tyre()], {}), e.prior_support)


@pytest.mark.parametrize("factor", [0.8, 1.25])
def test_a_tyre_file_a_fifth_off_leaves_the_truth_inside(run, tyre, factor):
    e = posterior(CAR, [run], DEFAULT_PRIOR, priors=informative_priors(CAR, [tyre(factor)], {}))
    assert inside(e.log_pad_ratio, math.log(RATIO))
    assert inside(e.compliance_f, 1.0 / STIFFNESS, 0.99)


def test_a_tyre_file_that_the_ramp_contradicts_is_told_and_not_followed(run, alone, tyre):
    priors = informative_priors(CAR, [tyre(2.2)], {})
    e = posterior(CAR, [run], DEFAULT_PRIOR, priors=priors)
    (warning,) = contradicted(priors, e.prior_support)
    assert (warning.code, warning.log) == ("tyre_file", "car")
    assert warning.measured < warning.expected[0] < 0.5
    assert np.mean(e.compliance_f) == pytest.approx(
        np.mean(alone.compliance_f), abs=0.5 * np.std(alone.compliance_f)
    )
    assert np.std(e.log_pad_ratio) > 0.8 * np.std(alone.log_pad_ratio)


@pytest.fixture(scope="module")
def fleet():
    """Draws of five cars of one tyre whose pads scatter by 7 % in ratio."""
    exact = Value(1.0, 0.01)
    pads = Calibration(exact, exact, exact, exact, exact)

    def car(seed, ratio):
        log = without(noisy(ramp(plant(ratio=ratio)), seed), "v")
        drawn = draws_of(CAR, posterior(CAR, [prepared(log)], DEFAULT_PRIOR), pads)
        return SimpleNamespace(draws=drawn, map=0, level_map=0)

    ratios = (0.93, 1.0, 1.07, 0.97, 1.04)
    return {f"c{i}@1": car(10 + i, ratio) for i, ratio in enumerate(ratios)}


def test_more_cars_say_more_but_never_more_than_cars_are_alike(fleet):
    (of_one,) = informative_priors(CAR, (), dict(list(fleet.items())[:1]))
    (of_five,) = informative_priors(CAR, (), fleet)
    (of_many,) = informative_priors(
        CAR, (), {f"{i}{id_}": t for i in range(40) for id_, t in fleet.items()}
    )
    for prior in (of_one, of_five, of_many):
        variance = np.diag(prior.covariance)
        assert np.all(variance > module._VARIANCE_IN_MODEL)
        assert np.all(variance < 1.01)
    assert np.trace(of_one.covariance) > np.trace(of_five.covariance) > np.trace(of_many.covariance)
    assert of_one.covariance[10, 10] == pytest.approx(1.0, abs=0.35)  # heights differ by loads


def test_a_car_on_other_tyres_is_told_and_not_pulled_over(fleet):
    other = prepared(noisy(ramp(plant(0.62 * STIFFNESS)), 3))
    priors, unaided = informative_priors(CAR, (), fleet), posterior(CAR, [other], DEFAULT_PRIOR)
    e = posterior(CAR, [other], DEFAULT_PRIOR, priors=priors)
    (warning,) = contradicted(priors, e.prior_support)
    assert warning.code == "fleet_prior"
    assert np.mean(e.compliance_f) == pytest.approx(np.mean(unaided.compliance_f), rel=0.03)
    assert inside(e.log_pad_ratio, math.log(RATIO))
