"""A linear Gaussian model of several logs, with the random effects of each log marginalised.

    r_i + A_i' dx + N_i' du_i ~ N(0, 1)      dx shared by all logs, du_i of log i alone

    prior  u_i ~ N(0, S^2)   x ~ N(m, 1/precision)

r_i are the innovations of log i at the present point, dx and du_i steps from that point. A Schur
complement removes the random effects of each log, so another S needs the inner products alone, not
the rows. Columns of A without a prior are called further ones; they stand behind the others.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array


@dataclass(frozen=True)
class Products:
    """Inner products of m shared columns, r, and k columns of random effects of a log."""

    gram: Array  # (m + 1 + k, m + 1 + k), in this order
    random_effects: Array  # (k,)

    @classmethod
    def from_columns(
        cls, shared: Array, random_columns: Array, r: Array, random_effects: Array
    ) -> "Products":
        """Compute the products of columns (m, n) and (k, n) and of innovations ``r`` (n,)."""
        rows = np.vstack([shared, r, random_columns])
        return cls(rows @ rows.T, random_effects)

    def marginalised(self, sigmas: Array, damping: float = 0.0) -> tuple[Array, Array, float]:
        """Return the products (m + 1, m + 1) without what random effects of ``sigmas`` explain.

        Also return the step (k, m + 1) of the random effects for each column, so that
        du = -step (dx, 1), and ln of the determinant of their information, to whose diagonal the
        share ``damping`` is added.
        """
        (use,) = np.nonzero(sigmas)
        m = len(self.gram) - sigmas.size
        S = sigmas[use]
        # information, in units of S, and its products with the other columns
        P = np.eye(S.size) + S[:, None] * self.gram[np.ix_(m + use, m + use)] * S
        P[np.diag_indices(S.size)] *= 1.0 + damping
        b = S[:, None] * self.gram[m + use, :m]
        t = self.random_effects[use] / S
        b[:, -1] += t
        solved = np.linalg.solve(P, b)
        G = self.gram[:m, :m] - b.T @ solved
        G[-1, -1] += t @ t
        step = np.zeros((sigmas.size, m))
        step[use] = S[:, None] * solved
        return G, step, float(np.linalg.slogdet(P)[1])


@dataclass(frozen=True)
class Marginal:
    """Products of all logs and of the prior, which is on the first k columns.

    ``log_determinants`` sums ln of the determinants of the random effects' information, less that
    of the prior.
    """

    information: Array  # products of the first k columns (k, k)
    cross: Array  # products of the first k columns with c further ones and r (k, c + 1)
    further: Array  # products of the further columns and r (c + 1, c + 1)
    log_determinants: float
    steps: list[Array]  # of each log, by `Products.marginalised`

    @classmethod
    def from_products(
        cls,
        products: list[Products],
        sigmas: Array,
        precision: Array,
        offset: Array,
        damping: float = 0.0,
    ) -> "Marginal":
        """Add up all logs and the prior of ``precision`` (k, k).

        ``offset`` (k,) is the present point less the mean of the prior.
        """
        logs = [of_log.marginalised(sigmas, damping) for of_log in products]
        G, k = np.sum([gram for gram, _, _ in logs], axis=0), offset.size
        # products of the prior's residual dx + offset, weighed by its precision
        prior, places = np.column_stack([np.eye(k), offset]), [*range(k), -1]
        G[np.ix_(places, places)] += prior.T @ precision @ prior
        log_determinants = sum(of_log for _, _, of_log in logs)
        log_determinants -= float(np.linalg.slogdet(precision)[1])
        steps = [step for _, step, _ in logs]
        return cls(G[:k, :k], G[:k, k:], G[k:, k:], log_determinants, steps)

    @property
    def gradient(self) -> Array:
        """Half the gradient (k,) of the sum of squares."""
        return self.cross[:, -1]

    @property
    def squares(self) -> float:
        """Sum of squares at the present point, priors included, with the best random effects."""
        return float(self.further[-1, -1])

    def evidence(self, largest_fall: float = np.inf) -> float:
        """ln of the evidence without the further columns, up to a constant of the rows.

        The sum of squares falls by at most ``largest_fall`` from here to the optimum.
        """
        H, g = self.information, self.gradient
        fall = min(float(g @ np.linalg.solve(H, g)), largest_fall)
        log_determinant = float(np.linalg.slogdet(H)[1])
        return 0.5 * (fall - self.squares - log_determinant - self.log_determinants)

    def eliminated(self) -> tuple[Array, Array]:
        """Normal equations (c, c), (c,) of the further columns, all others eliminated."""
        schur = self.further - self.cross.T @ np.linalg.solve(self.information, self.cross)
        return schur[:-1, :-1], -schur[:-1, -1]
