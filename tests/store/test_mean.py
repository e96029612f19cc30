"""What a run says of its own errors, against the scatter of many runs of one car."""

import numpy as np
import pytest

from calib.base.intervals import Z95
from calib.table.budget import own


def scatter(values):
    return float(np.std(values, ddof=1))


@pytest.mark.parametrize(
    ("name", "most"),
    [("ratio", 3.0), ("stiffness", 1.5)],
)
def test_the_own_error_of_a_logarithm_is_its_scatter_from_run_to_run(runs, name, most):
    """12 runs know a standard deviation to 21 %; what the prior holds scatters less than it says.

    The whole sigma is no measure of it: the pads' ratio scatters by a sixth of its own.
    """
    of_ratio = [t.calibration.pad_log_ratio.value for t in runs]
    of_tyres = [np.log(t.calibration.slip_stiffness.value) for t in runs]
    seen = scatter(of_ratio if name == "ratio" else of_tyres)
    of_run = np.sqrt(np.mean([own(getattr(t.budget, name)) for t in runs]))
    assert 0.65 * seen < of_run < most * seen
    if name == "ratio":
        assert np.mean([t.calibration.pad_log_ratio.sigma for t in runs]) > 4.0 * seen


def test_the_own_error_of_the_pad_level_is_its_scatter(runs):
    level = scatter([np.log(t.calibration.pad_scale.value) for t in runs])
    assert np.sqrt(own(runs[0].budget.level)) == pytest.approx(level, rel=0.4)


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
