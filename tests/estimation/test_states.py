"""The states before a stop: what the table gives, and what is opened around it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.estimation.priors import Priors
from calib.estimation.states import (
    AT,
    States,
    first_scatter,
    first_state,
    open_surface,
    places,
)
from calib.table.table import TyrePosterior

PRIORS = Priors()
NAMES = (
    *("log_compliance", "curvature_2", "curvature_3", "load_exponent"),
    *("clock_offset", "log_pad_ratio"),
)
MEAN = (math.log(0.04), 0.05, 0.4, 0.03, 0.001, 0.02)


def posterior(covariance, names=NAMES, mean=MEAN):
    return TyrePosterior(names, mean, tuple(tuple(row) for row in covariance))


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=36, max_size=36),
    st.lists(st.floats(0.001, 0.3), min_size=6, max_size=6),
)
def test_first_covariance_is_symmetric_and_positive(entries, sigmas):
    root = np.array(entries).reshape(6, 6) + 1.5 * np.eye(6)
    correlated = root @ root.T
    scale = np.array(sigmas) / np.sqrt(np.diag(correlated))
    covariance = correlated * np.outer(scale, scale) + 1e-10 * np.eye(6)
    known = posterior(covariance)
    x, P = first_state(known, PRIORS)
    assert np.array_equal(P, P.T)
    # load_shift starts with no variance: it gets its own with the first block
    rest = np.delete(np.delete(P, AT.load_shift, 0), AT.load_shift, 1)
    scaled = rest / np.sqrt(np.outer(np.diag(rest), np.diag(rest)))
    assert np.min(np.linalg.eigvalsh(scaled)) > 0.0
    assert P[AT.load_shift, AT.load_shift] == 0.0
    # what the ramp left open of the ratio is open today as well, and the pads' own change
    at = known.names.index("log_pad_ratio")
    ramp = known.covariance[at][at]
    assert P[AT.log_pad_ratio, AT.log_pad_ratio] == pytest.approx(ramp + PRIORS.ratio**2)
    assert P[AT.log_pad_ratio, AT.table_log_pad_ratio] == ramp
    assert x[AT.log_pad_ratio] == x[AT.table_log_pad_ratio] == known.value("log_pad_ratio")


def test_parameters_of_the_table_go_to_the_states_of_their_names():
    """The order in which a table names its parameters does not matter."""
    root = np.random.default_rng(0).normal(size=(6, 6))
    covariance = root @ root.T
    x, P = first_state(posterior(covariance), PRIORS)
    back = tuple(reversed(range(6)))
    other = posterior(
        covariance[np.ix_(back, back)],
        tuple(NAMES[i] for i in back),
        tuple(MEAN[i] for i in back),
    )
    assert np.array_equal(first_state(other, PRIORS)[0], x)
    assert np.array_equal(first_state(other, PRIORS)[1], P)
    assert x[AT.curvature_3] == 0.4
    assert x[AT.clock_offset] == 0.001
    assert P[AT.load_exponent, AT.clock_offset] == covariance[3, 4]
    assert places(("log_pad_ratio",)) == [States._fields.index("table_log_pad_ratio")]


def test_scatter_is_taken_out_of_the_covariance_and_kept_as_a_root():
    """Two directions of six; what pads scatter they do today as on the ramp."""
    root = np.random.default_rng(2).normal(size=(6, 6)) * np.array([[1e-2, 1, 1, 1, 1e-3, 1]]).T
    less, scatter = root[:, :4] @ root[:, :4].T, root[:, 4:] @ root[:, 4:].T
    known = posterior(less + scatter)
    with_it = replace(known, scatter=tuple(map(tuple, scatter.tolist())))
    _, P = first_state(with_it, PRIORS)
    np.testing.assert_allclose(P, first_state(posterior(less), PRIORS)[1], atol=1e-12)
    A = first_scatter(with_it)
    assert A.shape[1] == 2
    at = places(NAMES)
    np.testing.assert_allclose((A @ A.T)[np.ix_(at, at)], scatter, atol=1e-12)
    assert np.array_equal(A[AT.log_pad_ratio], A[AT.table_log_pad_ratio])
    assert first_scatter(known).shape == (len(A), 0)


def test_tyres_that_the_table_names_are_taken_from_it():
    root = np.random.default_rng(1).normal(size=(8, 8))
    covariance = root @ root.T
    names = (*NAMES, "log_tyre_ratio", "radius_load")
    x, P = first_state(posterior(covariance, names, (*MEAN, 0.07, 0.004)), PRIORS)
    assert (x[AT.log_tyre_ratio], x[AT.radius_load]) == (0.07, 0.004)
    assert P[AT.log_tyre_ratio, AT.log_tyre_ratio] == covariance[6, 6]
    assert P[AT.log_tyre_ratio, AT.log_compliance] == covariance[6, 0]
    # what changed since the ramp is beside it, not part of it
    assert P[AT.tyre_change, AT.tyre_change] == pytest.approx(PRIORS.tyre_change**2)
    assert not np.delete(P[AT.tyre_change], AT.tyre_change).any()


def test_the_peak_moves_with_the_stiffness():
    """Var of w = slope s + own; s and own independent."""
    _, P = first_state(posterior(np.eye(6)), PRIORS)
    s, w = AT.log_stiffness, AT.log_peak_ratio
    slope = PRIORS.peak_per_stiffness
    assert P[s, s] == pytest.approx(PRIORS.stiffness**2)
    assert P[s, w] == pytest.approx(slope * PRIORS.stiffness**2)
    assert P[w, w] == pytest.approx(PRIORS.peak**2 + slope**2 * PRIORS.stiffness**2)
    before = P.copy()
    open_surface(P, PRIORS, 0.5)
    opened = P - before
    assert opened[s, s] == pytest.approx(0.25 * PRIORS.stiffness**2)
    assert opened[s, w] == opened[w, s] == pytest.approx(slope * opened[s, s])
    assert opened[w, w] == pytest.approx(0.25 * PRIORS.peak**2 + slope**2 * opened[s, s])
    opened[np.ix_([s, w], [s, w])] = 0.0
    assert not opened.any()


def test_what_an_older_table_does_not_name_starts_as_before_a_ramp():
    """10 % between the axles' tyres and 0.3 % of radius per load, independent of all else."""
    x, P = first_state(posterior(np.eye(6)), PRIORS)
    for place, sigma in ((AT.log_tyre_ratio, 0.1), (AT.radius_load, 0.003), (AT.tyre_change, 0.02)):
        assert x[place] == 0.0
        assert P[place, place] == pytest.approx(sigma**2)
        assert not np.delete(P[place], place).any()
