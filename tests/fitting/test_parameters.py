"""The parameters of a ramp: by name, in whatever order a table holds them."""

import math

import numpy as np
import pytest

from calib.fitting.parameters import PRIORS, RampParameters, parameters_of, tyre_of
from calib.physics.tyre import Tyre
from calib.table.table import TyrePosterior

VALUES = {
    "log_pad_ratio": 0.1,
    "clock_offset": 0.002,
    "load_exponent": 0.03,
    "curvature_3": 0.4,
    "curvature_2": 0.05,
    "log_compliance": -3.2,
}
ROOT = np.random.default_rng(2).normal(size=(6, 6))
COVARIANCE = ROOT @ ROOT.T
POSTERIOR = TyrePosterior(
    tuple(VALUES), tuple(VALUES.values()), tuple(tuple(row) for row in COVARIANCE)
)


def test_means_are_read_by_name():
    assert parameters_of(POSTERIOR)._asdict() == VALUES
    assert tyre_of(parameters_of(POSTERIOR)) == POSTERIOR.tyre == Tyre(-3.2, 0.05, 0.4, 0.03)


def test_sigma_is_the_root_of_the_variance_of_that_name():
    assert POSTERIOR.variance("clock_offset") == COVARIANCE[1, 1]
    assert POSTERIOR.sigma("clock_offset") == pytest.approx(math.sqrt(COVARIANCE[1, 1]))
    with pytest.raises(ValueError, match="not in tuple"):
        POSTERIOR.sigma("clock")


def test_priors_hold_usual_tyres():
    """Slip stiffness 10 to 70 per load; brush b2 = 1/3, b3 = 0.2; Magic Formula 0 and 0.45."""
    for name, value in (
        ("log_compliance", math.log(1 / 10)),
        ("log_compliance", math.log(1 / 70)),
        ("curvature_2", 1 / 3),
        ("curvature_2", 0.0),
        ("curvature_3", 0.2),
        ("curvature_3", 0.45),
        ("clock_offset", 0.01),
    ):
        prior = PRIORS[RampParameters._fields.index(name)]
        assert abs(value - prior.mean) < 2.0 * prior.sigma, name
