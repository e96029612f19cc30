"""Least squares with secant updates against SciPy's with finite differences, and a closed form."""

import numpy as np
import pytest
from scipy import optimize

from calib.diagnosis.explanation.secant import columns, least_squares


def counted(function):
    calls = []

    def ask(x):
        calls.append(x.copy())
        return function(x)

    return ask, calls


@pytest.mark.parametrize("seed", range(5))
def test_a_curve_is_fitted_as_by_finite_differences_with_fewer_evaluations(seed):
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 4.0, 200)
    true = rng.uniform(0.5, 1.5, 6)

    def curve(x):
        return x[0] * np.exp(-x[1] * t) * np.cos(2.0 * x[2] * t) + x[3] * t / (x[4] + t) + x[5]

    measured = curve(true) + 0.01 * rng.standard_normal(t.size)
    start, low, high = true * 1.1, np.zeros(6), np.full(6, 3.0)
    ask, calls = counted(lambda x: curve(x) - measured)
    x, rest, _ = least_squares(ask, start, low, high, np.ones(6), 20)
    full, asked = counted(lambda x: curve(x) - measured)
    expected = optimize.least_squares(full, start, bounds=(low, high))
    assert float(rest @ rest) == pytest.approx(2.0 * expected.cost, rel=1e-3)
    assert np.array_equal(rest, curve(x) - measured)
    assert len(calls) < 0.7 * len(asked)


def test_a_straight_problem_is_solved_exactly_within_its_bounds():
    rng = np.random.default_rng(1)
    A, y = rng.standard_normal((30, 3)), rng.standard_normal(30)
    low, high = np.full(3, -10.0), np.full(3, 10.0)
    x, *_ = least_squares(lambda x: A @ x - y, np.zeros(3), low, high, np.ones(3), 20)
    assert x == pytest.approx(np.linalg.lstsq(A, y, rcond=None)[0], abs=1e-6)
    ceiling = np.array([10.0, 10.0, x[2] - 0.5])
    bound, *_ = least_squares(lambda x: A @ x - y, low * 0.1, low, ceiling, np.ones(3), 40)
    assert bound == pytest.approx(optimize.lsq_linear(A, y, (low, ceiling)).x, abs=1e-3)


def test_derivatives_step_away_from_an_upper_bound():
    seen = []

    def ask(x):
        seen.append(x[0])
        return np.array([x[0] ** 2])

    J = columns(ask, np.array([2.0]), np.array([4.0]), np.array([2.0]))
    assert max(seen) <= 2.0
    assert pytest.approx(4.0, abs=2e-3) == J[0, 0]


@pytest.mark.parametrize("error", [0.0, 0.2])
def test_derivatives_that_are_known_nearby_spare_evaluations_and_not_the_solution(error):
    rng = np.random.default_rng(2)
    A, noise = rng.standard_normal((40, 5)), 0.1 * rng.standard_normal(40)

    def response(x):
        return A @ x + 0.02 * (A @ x) ** 2

    def bent(x):
        return response(x) - response(np.ones(5)) - noise

    low, high = np.full(5, -10.0), np.full(5, 10.0)
    plain, few = counted(bent), counted(bent)
    x, *_ = least_squares(plain[0], np.zeros(5), low, high, np.ones(5), 20)
    nearby = A[:, :4] * (1.0 + error * rng.standard_normal((40, 4)))
    begun, left, _ = least_squares(few[0], np.zeros(5), low, high, np.ones(5), 20, nearby)
    expected = optimize.least_squares(bent, np.zeros(5), bounds=(low, high))
    assert float(left @ left) == pytest.approx(2.0 * expected.cost, rel=5e-3)
    assert begun == pytest.approx(x, abs=0.01)
    assert len(few[1]) < len(plain[1])


def test_a_rough_fit_promises_what_a_straight_problem_keeps():
    rng = np.random.default_rng(4)
    A, y = rng.standard_normal((60, 6)), rng.standard_normal(60)
    low, high = np.full(6, -10.0), np.full(6, 10.0)

    def residuals(x):
        return A @ x - y

    begun = least_squares(residuals, np.full(6, 5.0), low, high, np.ones(6), 1, rough=True)
    least = float(optimize.lsq_linear(A, y).cost) * 2.0
    assert float(begun.residuals @ begun.residuals) > 1.01 * least
    assert begun.promised == pytest.approx(least, rel=1e-4)
    done = least_squares(residuals, begun.x, low, high, np.ones(6), 20)
    assert done.promised == pytest.approx(float(done.residuals @ done.residuals))


def test_an_element_at_its_bound_promises_nothing():
    A, y = np.eye(3), np.array([1.0, 2.0, 5.0])
    low, high = np.zeros(3), np.array([10.0, 10.0, 3.0])
    start = np.array([0.5, 0.5, 3.0 - 1e-12])
    found = least_squares(lambda x: A @ x - y, start, low, high, np.ones(3), 1, rough=True)
    assert found.promised >= 4.0 - 1e-6
