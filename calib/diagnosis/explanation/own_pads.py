"""Pads and tyres of each log of its own, within what they repeat to from run to run.

    innovations r of a log = -J d + white noise,   d ~ N(0, S^2): pads in front and behind, tyre

J are the derivatives of the innovations, measured less predicted, by the logarithms of pads and
stiffness. So r has the covariance I + J S^2 J', and (I + J S^2 J')^-1/2 r is white: a log says what
it can of base and effects, and nothing of what its own pads may be. With J S = U s V', that factor
is I - U (1 - 1/sqrt(1 + s^2)) U', and the most likely d is -S V s/(1 + s^2) U' r. J is taken at one
explanation: pads that differ by a few per cent are linear there.

Source: the whitening of a linear Gaussian model (Gelman et al., Bayesian Data Analysis, ch. 15).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.base import Ground
from calib.diagnosis.gates import GATES

Array = NDArray[np.float64]

SIGMA = np.array([GATES.own_pads, GATES.own_pads, GATES.own_tyres])
"""Standard deviations of d: logarithms of the first factors of a `Ground`."""


@dataclass(frozen=True)
class OwnPads:
    """What the pads and the tyre of one log can do to its innovations, all channels in a row.

    ``basis`` U (k, 3), ``lost`` (3,) the share of what lies along it that is left out, ``likely``
    (3, k) times the innovations is the most likely -d.
    """

    basis: Array
    lost: Array
    likely: Array

    @classmethod
    def of(cls, derivatives: Array) -> Self:
        """From the derivatives J (k, 3) of the innovations."""
        U, s, V = np.linalg.svd(derivatives * SIGMA, full_matrices=False)
        pulled = (V.T * (s / (1.0 + s**2))) @ U.T
        return cls(U, 1.0 - 1.0 / np.sqrt(1.0 + s**2), SIGMA[:, None] * pulled)

    def whitened(self, innovations: list[Array]) -> list[Array]:
        """The innovations by channel, white if the pads and the tyre of the log are its own."""
        row = np.concatenate(innovations)
        row = row - self.basis @ (self.lost * (self.basis.T @ row))
        return np.split(row, np.cumsum([x.size for x in innovations])[:-1])

    def ground(self, innovations: list[Array], at: Ground) -> Ground:
        """The most likely ground of the log, from ``at``, for ``innovations`` without own pads."""
        found = at.logarithms
        found[: SIGMA.size] -= self.likely @ np.concatenate(innovations)
        return Ground.of(found)
