import numpy as np
import pytest

from calib.diagnosis.explanation.agreement import birge_ratio


def drawn(rng, apart):
    """Innovations of eight runs at the common optimum; ``apart`` the sd of their parameters."""
    J = rng.normal(size=(8 * 300, 3))
    truth = np.repeat(apart * rng.normal(size=(8, 3)), 300, axis=0)
    y = np.sum(J * truth, axis=1) + rng.normal(size=len(J))
    return J, y - J @ np.linalg.lstsq(J, y)[0]


def test_runs_that_agree_have_a_ratio_of_one():
    rng = np.random.default_rng(4)
    squares = [birge_ratio(*drawn(rng, 0.0), [300] * 8) ** 2 for _ in range(100)]
    assert np.mean(squares) == pytest.approx(1.0, abs=0.07)  # sd of a mean of 100 with 21 freedoms


def test_runs_that_disagree_have_the_ratio_of_their_scatter():
    # a parameter is known to 1/sqrt(300) in each run; scatter of 0.2 adds 300 * 0.04 to 1
    rng = np.random.default_rng(5)
    squares = [birge_ratio(*drawn(rng, 0.2), [300] * 8) ** 2 for _ in range(100)]
    assert np.mean(squares) == pytest.approx(13.0, rel=0.08)


def test_a_parameter_that_one_run_alone_shows_says_nothing_of_agreement():
    rng = np.random.default_rng(6)
    J = rng.normal(size=(600, 2))
    J[300:, 1] = 0.0
    y = rng.normal(size=600)
    rest = y - J @ np.linalg.lstsq(J, y)[0]
    (a, b) = (J[:300], J[300:, :1])
    own = [
        float(np.sum((p @ np.linalg.lstsq(p, r)[0]) ** 2))
        for p, r in ((a, rest[:300]), (b, rest[300:]))
    ]
    assert birge_ratio(J, rest, [300, 300]) == pytest.approx(np.sqrt(sum(own) / 1.0))
