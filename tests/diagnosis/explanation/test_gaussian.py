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

ROWS, SHARED, BEHIND = (9, 7, 11), 3, 2
SIZES = np.array([0.5, 0.0, 2.0])
"""Of own states; the second is nothing that logs differ in."""

SEEDS = given(st.integers(0, 10_000))


@dataclass(frozen=True)
class Drawn:
    """Columns of three logs, their innovations, a prior, and a point away from its mean."""

    shared: list[Array]
    own: list[Array]
    r: list[Array]
    state: list[Array]
    precision: Array
    off: Array

    @classmethod
    def of(cls, seed: int) -> "Drawn":
        rng = np.random.default_rng(seed)
        half = rng.standard_normal((SHARED, SHARED))
        return cls(
            [rng.standard_normal((SHARED + BEHIND, n)) for n in ROWS],
            [rng.standard_normal((SIZES.size, n)) for n in ROWS],
            [2.0 * rng.standard_normal(n) for n in ROWS],
            [rng.standard_normal(SIZES.size) * (SIZES > 0.0) for _ in ROWS],
            half @ half.T + 0.1 * np.eye(SHARED),
            rng.standard_normal(SHARED),
        )

    def products(self, count: int = SHARED + BEHIND) -> list[Products]:
        logs = zip(self.shared, self.own, self.r, self.state, strict=True)
        return [Products.from_columns(A[:count], N, r, u) for A, N, r, u in logs]

    def marginal(self) -> Marginal:
        """With columns behind those that have a prior."""
        return Marginal.from_products(self.products(), SIZES, self.precision, self.off)

    def log_density(self, behind: float = 0.0) -> float:
        """r = A'(x0 - x) + N'(u0 - u) + noise, over all x and u; columns ``behind`` of that sd."""
        A, N = np.hstack(self.shared), block_diag(*self.own)
        first, S = A[:SHARED], np.tile(SIZES, len(ROWS))
        mean = self.off @ first + np.concatenate(self.state) @ N
        covariance = np.eye(sum(ROWS)) + first.T @ np.linalg.solve(self.precision, first)
        covariance += (N.T * S**2) @ N + behind**2 * A[SHARED:].T @ A[SHARED:]
        return float(multivariate_normal(mean, covariance).logpdf(np.concatenate(self.r)))


CONSTANT = -0.5 * sum(ROWS) * np.log(2.0 * np.pi)


@SEEDS
def test_the_evidence_is_the_density_of_all_rows(seed):
    drawn = Drawn.of(seed)
    found = Marginal.from_products(drawn.products(SHARED), SIZES, drawn.precision, drawn.off)
    assert found.evidence() + CONSTANT == pytest.approx(drawn.log_density(), abs=1e-8)
    assert drawn.marginal().evidence() == pytest.approx(found.evidence(), abs=1e-9)


@SEEDS
def test_what_is_behind_raises_the_evidence_as_the_density_of_all_rows(seed):
    drawn, sd = Drawn.of(seed), 1.5
    E, g = drawn.marginal().eliminated()
    H = E + np.eye(BEHIND) / sd**2
    gain = 0.5 * (g @ np.linalg.solve(H, g) - np.linalg.slogdet(sd**2 * H)[1])
    assert gain == pytest.approx(drawn.log_density(sd) - drawn.log_density(), abs=1e-8)


@SEEDS
def test_own_states_step_to_the_least_squares_of_their_log(seed):
    """min |r + A'dx + N'du|^2 + |(u + du)/S|^2 over du, at any dx."""
    drawn, use = Drawn.of(seed), SIZES > 0.0
    dx = np.append(np.random.default_rng(seed).standard_normal(SHARED + BEHIND), 1.0)
    for i, one in enumerate(drawn.products()):
        N, r = drawn.own[i][use], drawn.r[i] + dx[:-1] @ drawn.shared[i]
        rows = np.vstack([N.T, np.diag(1.0 / SIZES[use])])
        aim = -np.concatenate([r, drawn.state[i][use] / SIZES[use]])
        G, step, _ = one.marginalised(SIZES)
        du, squares, *_ = np.linalg.lstsq(rows, aim, rcond=None)
        assert_allclose(-(step @ dx)[use], du, atol=1e-9)
        assert not np.any(step[~use])
        assert dx @ G @ dx == pytest.approx(squares.item())
