"""The precision in which the code of an ECU computes, and that of the maps it reads."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.table.exported import Precision


@dataclass(frozen=True)
class Width:
    """How the numbers are computed with: ``bits`` of the floating point, 32 or 64.

    ``how`` the maps are written: breakpoints, and the bits of their cells where these are integers.
    """

    bits: int
    how: Precision

    @classmethod
    def of(cls, how: Precision) -> Self:
        """Single precision where the table is written so or in integers, else double."""
        return cls(32 if how.single or how.bits else 64, how)

    @property
    def cell(self) -> str:
        """Type of the cells of the maps in C."""
        return f"int{self.how.bits}_t" if self.how.bits else "bte_real"

    def rounded(self, x: Array) -> Array:
        """Numbers as the floating point holds them."""
        return x.astype(np.float32).astype(np.float64) if self.bits == 32 else x

    def number(self, x: float) -> str:
        """A constant in C that reads back to the last bit of its precision."""
        told = repr(float(np.float32(x)) if self.bits == 32 else float(x))
        if self.bits == 32:
            told = np.format_float_scientific(np.float32(x), unique=True, trim="0")
        return f"{told}F" if self.bits == 32 else told
