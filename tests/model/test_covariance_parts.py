"""The covariance of a weighed fit taken apart, against the mixture itself and a closed form."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.mixtures import weigh_hypotheses
from calib.model.covariance_parts import PART, posterior_parts
from calib.model.parameters import AT, COUNT, PRIORS

DEPART = [AT.log_pad_ratio, AT.log_tyre_ratio, AT.radius_load]
WIDE = np.array([PRIORS[i].sigma for i in DEPART])


def weighed_fit(seed, cases):
    """A fit of random data with the priors of a ramp, weighed over ``cases`` (k, 3) of sigma."""
    rng = np.random.default_rng(seed)
    sigma = np.array([prior.sigma for prior in PRIORS])
    J = rng.normal(size=(12, COUNT)) / sigma * rng.uniform(0.3, 3.0)
    information = {part: np.zeros((COUNT, COUNT)) for part in dict.fromkeys(PART)}
    for i, part in enumerate(PART):
        information[part][i, i] += sigma[i] ** -2.0
    information["noise"] = J.T @ J
    covariance = np.linalg.inv(sum(information.values()))
    x = sigma * rng.normal(size=COUNT)
    own = covariance[np.ix_(DEPART, DEPART)]
    precision = np.linalg.inv(own)
    weighed = weigh_hypotheses(
        (precision - np.diag(WIDE**-2.0))[None],
        (precision @ x[DEPART])[None],
        cases,
        np.ones(len(cases)),
    )
    along = covariance[:, DEPART] @ precision
    spread = covariance + along @ (weighed.covariance - own) @ along.T
    return information, weighed, along, spread


@given(st.integers(0, 10_000))
def test_parts_are_positive_and_add_up_to_the_weighed_covariance(seed):
    free = np.array(list(product((False, True), repeat=3)))
    cases = np.where(free, WIDE, 0.1 * WIDE)
    information, weighed, along, spread = weighed_fit(seed, cases)
    parts = posterior_parts(information, weighed, along, DEPART, WIDE, cases, free)
    unit = np.sqrt(np.outer(np.diag(spread), np.diag(spread)))
    assert np.allclose(sum(parts.values()) / unit, spread / unit, atol=1e-8)
    for share in parts.values():
        assert np.min(np.linalg.eigvalsh(share / unit)) > -1e-8


def test_one_case_is_the_error_that_each_source_makes():
    """x - truth = C (J' noise + prior errors over their variance): drawn, and its covariance."""
    free = np.ones((1, 3), bool)
    information, weighed, along, _ = weighed_fit(5, WIDE[None])
    parts = posterior_parts(information, weighed, along, DEPART, WIDE, WIDE[None], free)
    covariance = np.linalg.inv(sum(information.values()))
    rng = np.random.default_rng(0)
    for part, own in information.items():
        drawn = rng.multivariate_normal(np.zeros(COUNT), own, 20_000) @ covariance
        spread = np.einsum("ki,ki->i", drawn, drawn) / len(drawn)
        assert spread == pytest.approx(np.diag(parts[part]), rel=0.08)


def test_the_spread_between_cases_goes_to_what_departs():
    """Two cases that differ in the tyres only: nothing between them is the pads'."""
    free = np.array([[False, False, False], [False, True, False]])
    cases = np.where(free, WIDE, 0.1 * WIDE)
    information, weighed, along, spread = weighed_fit(7, cases)
    parts = posterior_parts(information, weighed, along, DEPART, WIDE, cases, free)
    within = posterior_parts(
        information, weighed._replace(means=np.zeros((2, 3))), along, DEPART, WIDE, cases, free
    )
    for part, share in parts.items():
        if part == "tyres":
            assert np.trace(share - within[part]) > 0.0
        else:
            assert np.allclose(share, within[part])
    assert np.trace(sum(parts.values())) == pytest.approx(np.trace(spread))
