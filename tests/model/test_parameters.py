"""The parameters of a ramp: by name, in whatever order a table holds them."""

import math

import numpy as np
import pytest

from calib.car.tyre import AxleTyres, Tyre
from calib.model.parameters import PRIORS, RampParameters, parameters_of, tyres_of
from calib.table.table import TyrePosterior

VALUES = {
    "radius_load": 0.002,
    "log_tyre_ratio": 0.06,
    "log_pad_ratio": 0.1,
    "clock_offset": 0.002,
    "load_exponent": 0.03,
    "curvature_3": 0.4,
    "curvature_2": 0.05,
    "log_compliance": -3.2,
}
ROOT = np.random.default_rng(2).normal(size=(8, 8))
COVARIANCE = ROOT @ ROOT.T
POSTERIOR = TyrePosterior(
    tuple(VALUES), tuple(VALUES.values()), tuple(tuple(row) for row in COVARIANCE)
)


def test_means_are_read_by_name():
    assert parameters_of(POSTERIOR)._asdict() == VALUES
    assert POSTERIOR.tyre == Tyre(-3.2, 0.05, 0.4, 0.03)
    assert tyres_of(parameters_of(POSTERIOR)) == AxleTyres(POSTERIOR.tyre, 0.06, 0.002)


def test_an_older_table_has_one_curve_for_both_axles():
    """Six parameters: the tyres do not differ and the radii are those at rest, as was believed."""
    new = ("log_tyre_ratio", "radius_load")
    kept = [i for i, name in enumerate(VALUES) if name not in new]
    older = TyrePosterior(
        tuple(name for name in VALUES if name not in new),
        tuple(POSTERIOR.mean[i] for i in kept),
        tuple(tuple(COVARIANCE[i, kept]) for i in kept),
    )
    expected = VALUES | dict.fromkeys(new, 0.0)
    assert parameters_of(older)._asdict() == expected
    assert tyres_of(parameters_of(older)) == AxleTyres(POSTERIOR.tyre)


def test_sigma_is_the_root_of_the_variance_of_that_name():
    assert POSTERIOR.sigma("clock_offset") == pytest.approx(math.sqrt(COVARIANCE[3, 3]))
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
        ("log_tyre_ratio", 0.1),
        ("log_tyre_ratio", -0.15),
        ("radius_load", 0.004),
    ):
        prior = PRIORS[RampParameters._fields.index(name)]
        assert abs(value - prior.mean) < 2.0 * prior.sigma, name
