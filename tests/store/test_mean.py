"""Own errors of a run against the scatter of many runs, and draws of one more car."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t

from calib.base.intervals import Z95
from calib.store.mean import one_more
from calib.table.budget import per_run
from tests.support.cars_of_a_line import car_table


def scatter(values):
    return float(np.std(values, ddof=1))


@pytest.mark.parametrize(("name", "largest"), [("ratio", 3.0), ("stiffness", 1.5)])
def test_the_own_error_of_a_logarithm_is_its_scatter_from_run_to_run(runs, name, largest):
    """8 runs give a standard deviation to 27 %; the prior makes runs scatter less than they may.

    The whole sigma holds shared errors, too: the pad ratio scatters by a sixth of its sigma.
    """
    ratios = [t.calibration.pad_log_ratio.value for t in runs]
    tyres = [np.log(t.calibration.slip_stiffness.value) for t in runs]
    scatter_of_runs = scatter(ratios if name == "ratio" else tyres)
    error_of_run = np.sqrt(np.mean([per_run(getattr(t.budget, name)) for t in runs]))
    assert 0.65 * scatter_of_runs < error_of_run < largest * scatter_of_runs
    if name == "ratio":
        assert np.mean([t.calibration.pad_log_ratio.sigma for t in runs]) > 4.0 * scatter_of_runs


def test_the_own_error_of_the_pad_level_is_its_scatter(runs):
    level = scatter([np.log(t.calibration.pad_scale.value) for t in runs])
    assert np.sqrt(per_run(runs[0].budget.level)) == pytest.approx(level, rel=0.4)


def test_the_own_error_of_D_is_about_its_scatter(runs):
    """It may be more: pads and tyres that look alike scatter together."""
    eta = np.linspace(1.0, min(t.difference.eta[-1] for t in runs), 5)[1:]
    curves = [t.difference for t in runs]
    D = np.array([np.interp(eta, c.eta, c.D) for c in curves])
    sigma = np.array([np.interp(eta, c.eta, c.upper - c.lower) / (2 * Z95) for c in curves])
    share = np.array([np.interp(eta, c.eta, c.own) for c in curves])
    ratio = np.sqrt(np.mean(sigma**2 * share, axis=0)) / D.std(axis=0, ddof=1)
    assert np.all((ratio > 0.4) & (ratio < 3.0))
    assert np.all(ratio[1:] > 0.55)


def test_shares_are_shares(fitted):
    for share in (fitted.difference.own, fitted.tyre.own):
        assert share.shape == (61,)
        assert np.all((share[1:] > 0.0) & (share[1:] < 1.0))
        assert share[0] == 0.0


LEVELS = (-0.02, 0.01, 0.03, 0.05, -0.04)


def without_scatter(table):
    """Return the table with every draw at the mean of its draws."""
    draws = {name: np.full_like(x, np.mean(x)) for name, x in vars(table.draws).items()}
    return replace(table, draws=replace(table.draws, **draws))


@pytest.mark.parametrize("k", [2, 3, 5])
def test_one_more_car_is_of_students_distribution(k):
    """Of the 80 % interval: the draws of a car are equal, so that only the cars scatter."""
    cars = [without_scatter(car_table(n, level=level)) for n, level in enumerate(LEVELS[:k])]
    drawn = one_more(cars, 40_000)
    mean, sigma = np.mean(LEVELS[:k]), np.std(LEVELS[:k], ddof=1)
    half = t.ppf(0.9, k - 1) * sigma * np.sqrt(1.0 + 1.0 / k)
    ends = np.quantile(drawn.log_pad_level, [0.1, 0.9])
    np.testing.assert_allclose(ends, [mean - half, mean + half], atol=0.05 * half)
    assert np.ptp(drawn.peak) < 1e-12


def test_draws_of_one_more_car_scatter_as_those_of_a_car():
    car = car_table(1)
    drawn = one_more([car, car_table(2)], 20_000)
    for name, x in vars(car.draws).items():
        assert np.std(getattr(drawn, name)) == pytest.approx(np.std(x), rel=0.02, abs=1e-12)
