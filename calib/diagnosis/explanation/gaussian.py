"""A linear Gaussian model of several logs, with the random effects of each log marginalised.

    r_i + A_i' dx + N_i' du_i ~ N(0, 1)      dx shared by all logs, du_i of log i alone

    prior  u_i ~ N(0, S^2)   x ~ N(x0, 1/precision)

r_i are the innovations of log i at the present point, dx and du_i steps from that point. A Schur
complement removes the random effects of each log, so another S needs the inner products alone, not
the rows. Further columns of A, behind the others, have no prior.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array


@dataclass(frozen=True)
class Products:
    """Inner products of the columns of a log: m shared ones, r, and k of its random effects."""

    gram: Array  # (m + 1 + k, m + 1 + k), in this order
    random_effects: Array  # at the present point (k,)

    @classmethod
    def from_columns(
        cls, shared: Array, random_columns: Array, r: Array, random_effects: Array
    ) -> "Products":
        """Compute the products of columns (m, n) and (k, n) and of innovations ``r`` (n,)."""
        rows = np.vstack([shared, r, random_columns])
        return cls(rows @ rows.T, random_effects)

    def marginalised(self, sigmas: Array, damping: float = 0.0) -> tuple[Array, Array, float]:
        """Return the products (m + 1, m + 1) without what random effects of ``sigmas`` explain.

        Also return the step (k, m + 1) of the random effects, du = -step (dx, 1), and ln of the
        determinant of their information, whose diagonal is raised by the share ``damping``.
        """
        (use,) = np.nonzero(sigmas)
        size = len(self.gram) - sigmas.size  # m + 1
        S = sigmas[use]
        # information of du/S, and its products with the shared columns and r
        P = np.eye(S.size) + S[:, None] * self.gram[np.ix_(size + use, size + use)] * S
        P[np.diag_indices(S.size)] *= 1.0 + damping
        b = S[:, None] * self.gram[size + use, :size]
        scaled = self.random_effects[use] / S  # residuals of the prior
        b[:, -1] += scaled
        solved = np.linalg.solve(P, b)
        G = self.gram[:size, :size] - b.T @ solved
        G[-1, -1] += scaled @ scaled
        step = np.zeros((sigmas.size, size))
        step[use] = S[:, None] * solved
        return G, step, float(np.linalg.slogdet(P)[1])


@dataclass(frozen=True)
class Marginal:
    """Products of all logs and of the prior, which is on the first p columns."""

    information: Array  # products of the first p columns (p, p)
    cross: Array  # products of the first p columns with c further ones and r (p, c + 1)
    further: Array  # products of the further columns and r (c + 1, c + 1)
    log_determinants: float
    """Sum of ln of the determinants of the random effects' information, less that of the prior."""
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
        """Add up all logs and the prior of ``precision`` (p, p).

        ``offset`` (p,) is the present point less the mean of the prior.
        """
        logs = [of_log.marginalised(sigmas, damping) for of_log in products]
        grams, steps, determinants = zip(*logs, strict=True)
        G, p = np.sum(grams, axis=0), offset.size
        # the prior's residual dx + offset has columns in the first p places and in that of r
        prior, places = np.column_stack([np.eye(p), offset]), [*range(p), -1]
        G[np.ix_(places, places)] += prior.T @ precision @ prior
        log_determinants = sum(determinants) - float(np.linalg.slogdet(precision)[1])
        return cls(
            information=G[:p, :p],
            cross=G[:p, p:],
            further=G[p:, p:],
            log_determinants=log_determinants,
            steps=list(steps),
        )

    @property
    def gradient(self) -> Array:
        """Half the gradient of the sum of squares (p,)."""
        return self.cross[:, -1]

    @property
    def squares(self) -> float:
        """Sum of squares at the present x with the best random effects, priors included."""
        return float(self.further[-1, -1])

    def evidence(self, largest_fall: float = np.inf) -> float:
        """ln of the evidence without the further columns, up to a constant of the rows.

        The fall of the sum of squares to the optimum of x counts as at most ``largest_fall``.
        """
        H, g = self.information, self.gradient
        fall = min(float(g @ np.linalg.solve(H, g)), largest_fall)
        log_determinant = float(np.linalg.slogdet(H)[1])
        return 0.5 * (fall - self.squares - log_determinant - self.log_determinants)

    def eliminated(self) -> tuple[Array, Array]:
        """Matrix (c, c) and right side (c,) of the normal equations of further columns alone."""
        schur = self.further - self.cross.T @ np.linalg.solve(self.information, self.cross)
        return schur[:-1, :-1], -schur[:-1, -1]
