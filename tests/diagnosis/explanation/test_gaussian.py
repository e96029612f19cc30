"""The linear model of several logs against the normal distribution of all their rows at once."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import block_diag
from scipy.stats import multivariate_normal

from calib.base.arrays import Array
from calib.diagnosis.explanation.gaussian import Marginal, Products

ROWS, SHARED, FURTHER = (9, 7, 11), 3, 2
SIGMAS = np.array([0.5, 0.0, 2.0])
"""Standard deviations of the random effects; logs do not differ in the second one."""

SEEDS = given(st.integers(0, 10_000))


@dataclass(frozen=True)
class Drawn:
    """Columns of three logs, their innovations, a prior, and a point ``offset`` from its mean."""

    shared: list[Array]
    random_columns: list[Array]
    r: list[Array]
    random_effects: list[Array]
    precision: Array
    offset: Array

    @classmethod
    def from_seed(cls, seed: int) -> "Drawn":
        rng = np.random.default_rng(seed)
        half = rng.standard_normal((SHARED, SHARED))
        return cls(
            [rng.standard_normal((SHARED + FURTHER, n)) for n in ROWS],
            [rng.standard_normal((SIGMAS.size, n)) for n in ROWS],
            [2.0 * rng.standard_normal(n) for n in ROWS],
            [rng.standard_normal(SIGMAS.size) * (SIGMAS > 0.0) for _ in ROWS],
            half @ half.T + 0.1 * np.eye(SHARED),
            rng.standard_normal(SHARED),
        )

    def products(self, count: int = SHARED + FURTHER) -> list[Products]:
        logs = zip(self.shared, self.random_columns, self.r, self.random_effects, strict=True)
        return [Products.from_columns(A[:count], N, r, u) for A, N, r, u in logs]

    def marginal(self, count: int = SHARED + FURTHER) -> Marginal:
        return Marginal.from_products(self.products(count), SIGMAS, self.precision, self.offset)

    def log_density(self, further: float = 0.0) -> float:
        """r = A'(x0 - x) + N'(u0 - u) + noise, over all x and u; sd of the ``further`` columns."""
        A, N = np.hstack(self.shared), block_diag(*self.random_columns)
        first, S = A[:SHARED], np.tile(SIGMAS, len(ROWS))
        mean = self.offset @ first + np.concatenate(self.random_effects) @ N
        covariance = np.eye(sum(ROWS)) + first.T @ np.linalg.solve(self.precision, first)
        covariance += (N.T * S**2) @ N + further**2 * A[SHARED:].T @ A[SHARED:]
        return float(multivariate_normal(mean, covariance).logpdf(np.concatenate(self.r)))


CONSTANT = -0.5 * sum(ROWS) * np.log(2.0 * np.pi)


@SEEDS
def test_the_evidence_is_the_density_of_all_rows(seed):
    drawn = Drawn.from_seed(seed)
    evidence = drawn.marginal(SHARED).evidence()
    assert evidence + CONSTANT == pytest.approx(drawn.log_density(), abs=1e-8)
    assert drawn.marginal().evidence() == pytest.approx(evidence, abs=1e-9)


@SEEDS
def test_further_columns_raise_the_evidence_as_the_density_of_all_rows(seed):
    drawn, sd = Drawn.from_seed(seed), 1.5
    E, g = drawn.marginal().eliminated()
    H = E + np.eye(FURTHER) / sd**2
    gain = 0.5 * (g @ np.linalg.solve(H, g) - np.linalg.slogdet(sd**2 * H)[1])
    assert gain == pytest.approx(drawn.log_density(sd) - drawn.log_density(), abs=1e-8)


@SEEDS
def test_random_effects_step_to_the_least_squares_of_their_log(seed):
    """min |r + A'dx + N'du|^2 + |(u + du)/S|^2 over du, at any dx."""
    drawn, use = Drawn.from_seed(seed), SIGMAS > 0.0
    dx = np.append(np.random.default_rng(seed).standard_normal(SHARED + FURTHER), 1.0)
    for i, products in enumerate(drawn.products()):
        N, r = drawn.random_columns[i][use], drawn.r[i] + dx[:-1] @ drawn.shared[i]
        rows = np.vstack([N.T, np.diag(1.0 / SIGMAS[use])])
        side = -np.concatenate([r, drawn.random_effects[i][use] / SIGMAS[use]])
        G, step, _ = products.marginalised(SIGMAS)
        du, squares, *_ = np.linalg.lstsq(rows, side, rcond=None)
        assert_allclose(-(step @ dx)[use], du, atol=1e-9)
        assert not np.any(step[~use])
        assert dx @ G @ dx == pytest.approx(squares.item())
