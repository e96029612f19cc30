"""A linear Gaussian model of several logs, what each has of its own marginalised.

    r_i + A_i' dx + N_i' du_i ~ N(0, 1)      dx shared by all logs, du_i of log i alone

    prior  u_i ~ N(0, S^2)   x ~ N(m, 1/precision)

Own states go out by a Schur complement for each log, so a hypothesis on their sizes S costs no
look at the rows.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array


@dataclass(frozen=True)
class Products:
    """Inner products ``gram`` (m + 1 + k, m + 1 + k) of one log, and its own ``state`` (k,).

    Of shared columns, of r, and of own columns, in this order.
    """

    gram: Array
    state: Array

    @classmethod
    def from_columns(
        cls, shared: Array, random_effects: Array, r: Array, state: Array
    ) -> "Products":
        """From columns (m, n) and (k, n), innovations (n,), and own states (k,) at them."""
        rows = np.vstack([shared, r, random_effects])
        return cls(rows @ rows.T, state)

    def reduced(self, sizes: Array, damping: float = 0.0) -> tuple[Array, Array, float]:
        """The products (m + 1, m + 1) without what own states of these ``sizes`` (k,) explain.

        With the step (k, m + 1) of the own states that goes with each column, so that du = -step
        (dx, 1); and ln of the determinant of their information. ``damping`` adds that share to its
        diagonal.
        """
        m, (use,) = len(self.gram) - sizes.size, np.nonzero(sizes)
        S = sizes[use]
        P = np.eye(S.size) + S[:, None] * self.gram[np.ix_(m + use, m + use)] * S
        P[np.diag_indices(S.size)] *= 1.0 + damping
        t = self.state[use] / S
        b = S[:, None] * self.gram[m + use, :m]
        b[:, -1] += t
        solved = np.linalg.solve(P, b)
        G = self.gram[:m, :m] - b.T @ solved
        G[-1, -1] += t @ t
        step = np.zeros((sizes.size, m))
        step[use] = S[:, None] * solved
        return G, step, float(np.linalg.slogdet(P)[1])


@dataclass(frozen=True)
class Marginal:
    """Products of all logs and of the prior, which is on the first k columns.

    ``information`` (k, k) of these, ``cross`` (k, c + 1) with the columns behind and r, ``behind``
    (c + 1, c + 1) of those. ``spent`` ln of the determinants of the own states' information over
    that of the prior; ``steps`` of each log as `Products.reduced` has it.
    """

    information: Array
    cross: Array
    behind: Array
    spent: float
    steps: list[Array]

    @classmethod
    def from_products(
        cls,
        products: list[Products],
        sizes: Array,
        precision: Array,
        off: Array,
        damping: float = 0.0,
    ) -> "Marginal":
        """Of all logs; ``precision`` (k, k) of the prior, whose mean is ``off`` (k,) away."""
        grams, steps, logs = zip(*(one.reduced(sizes, damping) for one in products), strict=True)
        G, k = np.sum(grams, axis=0), off.size
        rows, first = np.column_stack([np.eye(k), off]), [*range(k), -1]
        G[np.ix_(first, first)] += rows.T @ precision @ rows
        spent = sum(logs) - float(np.linalg.slogdet(precision)[1])
        return cls(G[:k, :k], G[:k, k:], G[k:, k:], spent, list(steps))

    @property
    def gradient(self) -> Array:
        """Half the gradient (k,) of the sum of squares."""
        return self.cross[:, -1]

    @property
    def squares(self) -> float:
        """Sum of squares at the present point, priors included, own states at their best."""
        return float(self.behind[-1, -1])

    def evidence(self, most: float = np.inf) -> float:
        """ln of the evidence but for a constant of the rows, without the columns behind the prior.

        ``most`` is the largest fall of the sum of squares to the optimum that is believed.
        """
        H, g = self.information, self.gradient
        fall = min(float(g @ np.linalg.solve(H, g)), most)
        return 0.5 * (fall - self.squares - float(np.linalg.slogdet(H)[1]) - self.spent)

    def beyond(self) -> tuple[Array, Array]:
        """What columns behind the prior do beyond the others: products (c, c), -r along (c,)."""
        schur = self.behind - self.cross.T @ np.linalg.solve(self.information, self.cross)
        return schur[:-1, :-1], -schur[:-1, -1]
