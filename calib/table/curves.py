"""The curves of a table with their 95 % bands: D(eta), f1(eta) and f2(eta), g(slip).

Rows are medians and quantiles of the posterior, in equal steps of eta or slip.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from calib.base.arrays import Array, Mask

MEASURED, INTERPOLATED, EXTRAPOLATED = 0.0, 1.0, 2.0
"""Flags of a row: it has enough blocks of 50 ms; it lies between such rows; it lies beyond them."""


@dataclass(frozen=True)
class DifferenceCurve:
    """D = F_f - F_r over eta, on the branch where eta rises; D(1) = 0. Shapes (n,), all [1]."""

    eta: Array
    D: Array
    lower: Array  # lower end of the 95 % band
    upper: Array
    count: Array  # number of measured blocks within 1.5 steps of the row
    flag: Array  # one of the flags above
    own: Array  # share of the variance that differs from run to run of a car; 0 in a mean of cars

    @property
    def peak(self) -> tuple[float, float]:
        """(eta, D) [1] where the magnitude of D is largest."""
        i = int(np.argmax(np.abs(self.D)))
        return float(self.eta[i]), float(self.D[i])

    @property
    def band_width(self) -> float | None:
        """Half width of the band over D where D is largest [1]; None where D is 0."""
        i = int(np.argmax(np.abs(self.D)))
        half = 0.5 * float(self.upper[i] - self.lower[i])
        return half / abs(float(self.D[i])) if self.D[i] else None


@dataclass(frozen=True)
class PaperCurves:
    """f1, f2 of (11), (12) and Fig. 6 over eta, where they are single-valued. Shapes (n,), all [1].

    (18) holds in every row. Columns are as in `DifferenceCurve`.
    """

    eta: Array
    z: Array  # deceleration of the ramp at this eta
    f1: Array
    f1_lower: Array
    f1_upper: Array
    f2: Array
    f2_lower: Array
    f2_upper: Array
    count: Array
    flag: Array

    def read(self, name: str, eta: ArrayLike) -> Array:
        """Return a column at ``eta`` [1], linear between rows; NaN beyond the measured rows."""
        rows = self.measured_rows
        column: Array = getattr(self, name)
        return np.asarray(np.interp(np.asarray(eta), self.eta[rows], column[rows], np.nan, np.nan))

    @property
    def measured_rows(self) -> Mask:
        """Whether each row (n,) is not extrapolated; the first row, eta = 1, counts as measured."""
        return np.asarray((self.flag != EXTRAPOLATED) | (np.arange(self.flag.size) == 0))

    @property
    def decelerations(self) -> tuple[float, float]:
        """Least and greatest z [1] of all rows, also of the extrapolated rows."""
        return _ends(self.z)

    @property
    def usable(self) -> tuple[float, float]:
        """Least and greatest z [1] of the measured rows, between which the table is usable."""
        return _ends(self.z[self.measured_rows])

    @property
    def usable_eta(self) -> tuple[float, float]:
        """Least and greatest eta [1] of the measured rows."""
        return _ends(self.eta[self.measured_rows])


def _ends(x: Array) -> tuple[float, float]:
    return float(np.min(x)), float(np.max(x))


@dataclass(frozen=True)
class TyreCurve:
    """The tyre curve g(slip), common to both axles; columns as in `DifferenceCurve`."""

    slip: Array
    force: Array  # normalised force where the axle carries half of the weight
    lower: Array
    upper: Array
    count: Array
    flag: Array
    own: Array
