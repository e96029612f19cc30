"""Distance of a car's table from the golden table of its model: D(eta), pads, tyres.

D is compared where both are measured. D = C (eta - 1) depends on the road, so the golden table has
to be one of the same track; so does the stiffness of the tyres, while that of the pads does not.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.table.table import Table

Array = NDArray[np.float64]

OVERLAP = 0.5
"""Share of the golden table's range of eta that must be common for a distance to mean anything."""


@dataclass(frozen=True)
class Distance:
    """``relative``: largest departure of D over the golden peak [1]; ``bands``: the same over the
    combined 95 % half widths at its eta ``at`` [1]; above 1 the difference is significant.

    ``bands`` is infinite where neither table has a band. Near eta = 1 both widths go to zero, so
    the ratio to them has no meaning there.
    """

    relative: float
    bands: float
    at: float


def distance(table: Table, golden: Table) -> Distance | None:
    """Largest departure of D(eta); None where less than half of the golden range is common."""
    ours, theirs = table.difference, golden.difference
    end = common_end(table, golden)
    if end is None:
        return None
    # both are linear between their rows, so the largest departure is at a row of one of them
    rows = np.union1d(ours.eta, theirs.eta)
    eta = rows[(rows > 1.0) & (rows <= end)]
    a, b = (np.interp(eta, d.eta, d.D) for d in (ours, theirs))
    widths = [0.5 * np.interp(eta, d.eta, d.upper - d.lower) for d in (ours, theirs)]
    apart: Array = np.abs(a - b)
    worst = int(np.argmax(apart))
    largest, width = float(apart[worst]), float(np.hypot(*widths)[worst])
    return Distance(
        relative=largest / abs(theirs.peak[1]),
        bands=largest / width if width > 0.0 else np.inf if largest > 0.0 else 0.0,
        at=float(eta[worst]),
    )


def common_end(table: Table, golden: Table) -> float | None:
    """Eta [1] up to which both have D; None where less than half of the golden range is common."""
    golden_end = float(golden.difference.eta[-1])
    end = min(float(table.difference.eta[-1]), golden_end)
    return None if end - 1.0 < OVERLAP * (golden_end - 1.0) else end


@dataclass(frozen=True)
class Ratios:
    """Pad friction of the axles and slip stiffness of the tyres over the golden table's [1]."""

    front: float
    rear: float
    stiffness: float


def ratios_to(table: Table, golden: Table) -> Ratios:
    """Pads and tyres of a table over those of the golden one: a D that agrees may hide both."""
    ours, theirs = table.calibration, golden.calibration
    compliance = [t.posterior.value("log_compliance") for t in (table, golden)]
    return Ratios(
        front=ours.pad_friction_f.value / theirs.pad_friction_f.value,
        rear=ours.pad_friction_r.value / theirs.pad_friction_r.value,
        stiffness=math.exp(compliance[1] - compliance[0]),
    )
