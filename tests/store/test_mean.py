"""What a run says of its own errors, against the scatter of many runs of one car."""

import numpy as np
import pytest

from calib.base.intervals import Z95
from calib.store.mean import own_covariance, own_level, own_share, own_share_of_tyre


def scatter(values):
    return float(np.std(values, ddof=1))


NAMES = ("log_compliance", "curvature_2", "curvature_3", "load_exponent")


@pytest.mark.parametrize("name", [*NAMES, "clock_offset", "log_pad_ratio", "log_tyre_ratio"])
def test_the_own_error_of_a_parameter_is_its_scatter_from_run_to_run(runs, name):
    """12 runs know a standard deviation to 21 %; what the prior holds scatters less than it says.

    So does the offset of the clock: its error counts radii that walk, and those of the runs do not.
    The whole sigma is no measure of it: the pads' ratio scatters by a sixth of its own.
    """
    at = runs[0].posterior.names.index(name)
    seen = scatter([t.posterior.mean[at] for t in runs])
    own = np.sqrt(np.mean([own_covariance(t)[at, at] for t in runs]))
    assert 0.65 * seen < own < (1.5 if name in NAMES else 3.0) * seen
    if name == "log_pad_ratio":
        assert np.mean([t.posterior.sigma(name) for t in runs]) > 4.0 * seen


def test_the_own_error_of_the_pad_level_is_its_scatter(runs):
    level = scatter([np.log(t.calibration.pad_scale.value) for t in runs])
    assert np.sqrt(own_level(runs[0])) == pytest.approx(level, rel=0.4)


def test_the_own_error_of_D_is_about_its_scatter(runs):
    """It may be more: pads and tyres that look alike scatter together. At small eta it is half:
    what the departure from the forms takes of the noise is no parameter of the posterior."""
    eta = np.linspace(1.0, min(t.difference.eta[-1] for t in runs), 5)[1:]
    curves = [t.difference for t in runs]
    D = np.array([np.interp(eta, c.eta, c.D) for c in curves])
    sigma = np.array([np.interp(eta, c.eta, c.upper - c.lower) / (2 * Z95) for c in curves])
    own = np.sqrt(np.mean(sigma**2 * [own_share(t, eta) for t in runs], axis=0))
    ratio = own / D.std(axis=0, ddof=1)
    assert np.all((ratio > 0.4) & (ratio < 3.0))
    assert np.all(ratio[1:] > 0.55)


def test_shares_are_shares_and_a_table_without_a_budget_has_none(fitted, table):
    eta, slip = fitted.difference.eta, fitted.tyre.slip
    for share in (own_share(fitted, eta), own_share_of_tyre(fitted, slip)):
        assert share.shape == (61,)
        assert np.all((share[1:] > 0.0) & (share[1:] < 1.0))
        assert share[0] == 0.0
    assert not np.any(own_share(table, table.difference.eta))
    assert not np.any(own_share_of_tyre(table, table.tyre.slip))
    assert own_level(table) == 0.0
    assert not np.any(own_covariance(table))
