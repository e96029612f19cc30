r"""The three look-ups of a table from one identified tyre: D(eta), f1 and f2(eta), and g(slip).

On a ramp the deceleration z orders everything, so z is the parameter; nothing is binned by eta:

    z --(pads, loads)--> F_f, F_r --tyre--> eta          D = F_f - F_r

       eta            The rising branch ends at the peak of eta. Beyond it the same eta is met
        |    __.      again at a higher z with another f1: f1 and f2 of Fig. 6 end there.
        |  /    \
        | /
        +------- z

Ramps with one axle only take no part: their eta goes with z in another way. Bands are 95 % and
follow from the posterior by the delta method.
"""

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import Z95
from calib.car.forces import paper_curves
from calib.car.vehicle import Vehicle
from calib.fitting.identify import Identified
from calib.fitting.one_axle_ramps import with_both_axles
from calib.fitting.path import Path, delta_sigma, path
from calib.model.parameters import RampParameters, tyres_of
from calib.model.ramp import RampRun
from calib.model.settings import SETTINGS
from calib.table.table import (
    EXTRAPOLATED,
    INTERPOLATED,
    MEASURED,
    DifferenceCurve,
    PaperCurves,
    TyreCurve,
)

Array = NDArray[np.float64]


def difference_curve(
    vehicle: Vehicle, found: Identified, runs: list[RampRun], z_end: float
) -> DifferenceCurve:
    """D(eta) over the rising branch, up to ``z_end`` [1].

    The band is that of D at a given eta: the error of eta along the path counts as one of D.
    """
    p = path(vehicle, found.mean, np.linspace(0.0, z_end, SETTINGS.rows))
    eta = np.linspace(1.0, float(p.eta[-1]), SETTINGS.rows)
    D = np.interp(eta, p.eta, p.D)
    sigma = delta_sigma(lambda x: _at_eta(path(vehicle, x, p.z), eta), found.posterior)
    count = _count(eta, np.concatenate([_measured_eta(r, e) for r, e in _zeroed(runs, found)]))
    return DifferenceCurve(eta, D, D - Z95 * sigma, D + Z95 * sigma, count, _flags(count))


def paper_table(
    vehicle: Vehicle, found: Identified, runs: list[RampRun], z_end: float
) -> PaperCurves:
    """f1(eta) and f2(eta) of Fig. 6 from D, at the load split of the ramp's z; (18) is exact."""
    p = path(vehicle, found.mean, np.linspace(0.0, z_end, SETTINGS.rows))
    d = difference_curve(vehicle, found, runs, z_end)
    z = np.interp(d.eta, p.eta, p.z)
    f1, f2 = paper_curves(vehicle, z, d.D)
    f1_a, f2_a = paper_curves(vehicle, z, d.lower)
    f1_b, f2_b = paper_curves(vehicle, z, d.upper)
    return PaperCurves(d.eta, z, f1, f1_a, f1_b, f2, f2_b, f2_a, d.count, d.flag)


def tyre_curve(vehicle: Vehicle, found: Identified, runs: list[RampRun], z_max: float) -> TyreCurve:
    """Normalised force over slip with half the weight on the axle, up to the greatest measured."""
    top = path(vehicle, found.mean, np.asarray([z_max]))
    greatest = 1.1 * float(max(top.F_f[0], top.F_r[0]))
    # beyond the end, where the band needs it
    force = np.linspace(0.0, 1.3 * greatest, 2 * SETTINGS.rows)
    one = np.ones(())

    def slip(parameters: RampParameters[float]) -> Array:
        return tyres_of(parameters).tyre.slip(force, one)

    end = float(tyres_of(found.mean).tyre.slip(np.asarray(greatest), one))
    grid = np.linspace(0.0, end, SETTINGS.rows)
    g = np.interp(grid, slip(found.mean), force)
    sigma = delta_sigma(lambda x: np.interp(grid, slip(x), force), found.posterior)
    slips = [
        np.concatenate([p.slip_f, p.slip_r])
        for p in (path(vehicle, found.mean, r.blocks.z[r.use]) for r in with_both_axles(runs))
    ]
    count = _count(grid, np.concatenate(slips))
    return TyreCurve(grid, g, g - Z95 * sigma, g + Z95 * sigma, count, _flags(count))


def _at_eta(p: Path, eta: Array) -> Array:
    top = int(np.argmax(p.eta)) + 1
    return np.interp(eta, p.eta[:top], p.D[:top])


def _zeroed(runs: list[RampRun], found: Identified) -> list[tuple[RampRun, Array]]:
    return [
        (run, run.blocks.eta / (1.0 + zero))
        for run, zero in zip(runs, found.eta_zero, strict=True)
        if run.only is None
    ]


def _measured_eta(run: RampRun, eta: Array) -> Array:
    return np.asarray(eta[run.use & ~run.blocks.lead_in])


def _count(grid: Array, measured: Array) -> Array:
    """How many of ``measured`` lie within one and a half rows of each row of the grid."""
    reach = 1.5 * (grid[1] - grid[0])
    ordered = np.sort(measured)
    above = np.searchsorted(ordered, grid + reach)
    below = np.searchsorted(ordered, grid - reach)
    return np.asarray(above - below, dtype=float)


def _flags(count: Array) -> Array:
    measured = count >= SETTINGS.min_count
    flags = np.full(count.size, EXTRAPOLATED)
    if measured.any():
        first, last = np.flatnonzero(measured)[[0, -1]]
        flags[first : last + 1] = INTERPOLATED
        flags[: first + 1] = INTERPOLATED  # D(1) = 0 is known
    flags[measured] = MEASURED
    return flags
