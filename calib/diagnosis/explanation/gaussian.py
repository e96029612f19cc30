"""A linear Gaussian model of several logs, with the random effects of each log marginalised.

    r_i + A_i' dx + N_i' du_i ~ N(0, 1)      dx shared by all logs, du_i of log i alone

    prior  u_i ~ N(0, S^2)   x ~ N(m, 1/precision)

r_i are the innovations of log i at the present point, dx and du_i steps from that point. A Schur
complement removes the random effects of each log, so a hypothesis on their standard deviations S
needs the inner products alone, not the rows. Columns of A without a prior are called further ones;
they stand behind the others.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array


@dataclass(frozen=True)
class Products:
    """Inner products ``gram`` (m + 1 + k, m + 1 + k) of a log, and its random effects (k,).

    The products are of the m shared columns, of r, and of the k columns of the random effects, in
    this order.
    """

    gram: Array
    random_effects: Array

    @classmethod
    def from_columns(
        cls, shared: Array, random_columns: Array, r: Array, random_effects: Array
    ) -> "Products":
        """Compute the products of columns (m, n) and (k, n) and of innovations ``r`` (n,)."""
        rows = np.vstack([shared, r, random_columns])
        return cls(rows @ rows.T, random_effects)

    def marginalised(self, sigmas: Array, damping: float = 0.0) -> tuple[Array, Array, float]:
        """The products (m + 1, m + 1) without what random effects of ``sigmas`` (k,) explain.

        Also return the step (k, m + 1) of the random effects for each column, so that
        du = -step (dx, 1), and ln of the determinant of their information. ``damping`` adds that
        share to the diagonal of the information.
        """
        (use,) = np.nonzero(sigmas)
        m = len(self.gram) - sigmas.size
        S = sigmas[use]
        P = np.eye(S.size) + S[:, None] * self.gram[np.ix_(m + use, m + use)] * S
        P[np.diag_indices(S.size)] *= 1.0 + damping
        t = self.random_effects[use] / S
        b = S[:, None] * self.gram[m + use, :m]
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

    ``information`` (k, k) is that of these columns, ``cross`` (k, c + 1) their products with the c
    further columns and r, ``further`` (c + 1, c + 1) the products of further columns and r.
    ``log_determinants`` is the sum over the logs of ln of the determinant of the random effects'
    information, less that of the prior; ``steps`` are those of each log by `Products.marginalised`.
    """

    information: Array
    cross: Array
    further: Array
    log_determinants: float
    steps: list[Array]

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
        log_determinants = sum(log for _, _, log in logs)
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

        ``largest_fall`` of the sum of squares to the optimum is believed, no more.
        """
        H, g = self.information, self.gradient
        fall = min(float(g @ np.linalg.solve(H, g)), largest_fall)
        log_determinant = float(np.linalg.slogdet(H)[1])
        return 0.5 * (fall - self.squares - log_determinant - self.log_determinants)

    def eliminated(self) -> tuple[Array, Array]:
        """Normal equations of the further columns, the others eliminated: matrix (c, c), side (c,).

        The side is the product of the columns with -r.
        """
        schur = self.further - self.cross.T @ np.linalg.solve(self.information, self.cross)
        return schur[:-1, :-1], -schur[:-1, -1]
