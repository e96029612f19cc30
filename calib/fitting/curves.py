r"""The three look-ups of a table from one identified tyre: D(eta), f1 and f2(eta), and g(slip).

On a ramp the deceleration z orders everything, so z is the parameter; nothing is binned by eta:

    z --(pads, loads)--> F_f, F_r --tyre--> eta          D = F_f - F_r

       eta            The rising branch ends at the peak of eta. Beyond it the same eta is met
        |    __.      again at a higher z with another f1: f1 and f2 of Fig. 6 end there.
        |  /    \
        | /
        +------- z

Bands are 95 % and follow from the posterior by the delta method.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.fitting.identify import Identified, RampRun
from calib.names import G
from calib.physics.balance import brake_forces
from calib.physics.forces import axle_loads, paper_curves, speed_ratio
from calib.physics.tyre import Tyre
from calib.physics.vehicle import Vehicle
from calib.table.table import (
    EXTRAPOLATED,
    INTERPOLATED,
    MEASURED,
    DifferenceCurve,
    PaperCurves,
    TyreCurve,
)

Array = NDArray[np.float64]

ROWS = 61
"""Rows of a look-up: linear interpolation between them errs by less than 1e-4 in D."""

MIN_COUNT = 3
"""Blocks a cell needs to count as measured."""


@dataclass(frozen=True)
class Path:
    """The ramp as the identified model has it, over z. Shapes (n,), all [1]."""

    z: Array
    F_f: Array
    F_r: Array
    slip_f: Array
    slip_r: Array

    @property
    def eta(self) -> Array:
        """(22)."""
        return speed_ratio(self.slip_f, self.slip_r)

    @property
    def D(self) -> Array:
        """F_f - F_r."""
        return self.F_f - self.F_r


def path(vehicle: Vehicle, parameters: Array, z: Array) -> Path:
    """Forces and slips over z [1], quasi-steady: no drag, wheels slowed with the car.

    The tyres carry W z; the brakes also stop the wheels themselves, J d omega/dt with
    d omega/dt = -g z/R. One master-cylinder pressure for both axles.
    """
    load_f, load_r = axle_loads(vehicle, z)
    B_f, B_r = brake_forces(vehicle, np.ones(()), np.ones(()), parameters[5])
    share = B_f / (B_f + B_r)
    inertia_f, inertia_r = (
        2.0 * a.wheel_inertia * G * z / a.rolling_radius**2 for a in (vehicle.front, vehicle.rear)
    )
    brakes = vehicle.weight * z + inertia_f + inertia_r
    F_f = (share * brakes - inertia_f) / load_f
    F_r = ((1.0 - share) * brakes - inertia_r) / load_r
    tyre = Tyre(*parameters[:4])
    half = 0.5 * vehicle.weight
    return Path(z, F_f, F_r, tyre.slip(F_f, load_f / half), tyre.slip(F_r, load_r / half))


@dataclass(frozen=True)
class Peak:
    """Where eta turns on the ramp: ``z``, ``eta`` [1]; ``real`` if it falls by 3 sigma after it."""

    z: float
    eta: float
    real: bool


def find_peak(vehicle: Vehicle, found: Identified, z_max: float) -> Peak:
    """Test whether eta peaks inside the measured range: its fall after the peak over its sigma."""
    z = np.linspace(0.0, z_max, 201)
    eta = path(vehicle, found.mean, z).eta
    top = int(np.argmax(eta))

    def fall(parameters: Array) -> Array:
        e = path(vehicle, parameters, z).eta
        return np.asarray([e[top] - e[-1]])

    sigma = delta_sigma(fall, found)[0]
    return Peak(float(z[top]), float(eta[top]), bool(eta[top] - eta[-1] > 3.0 * sigma))


FLAT = 0.1
"""Share of its first slope at which eta over z is too flat to be read backwards: there an error of
eta moves D ten times as far as it should."""


def readable_up_to(vehicle: Vehicle, found: Identified, z_max: float) -> float:
    """Greatest z [1] up to which eta rises steeply enough that f1 and f2 can be read from it."""
    z = np.linspace(0.0, z_max, 201)
    slope = np.diff(path(vehicle, found.mean, z).eta)
    flat = np.flatnonzero(slope < FLAT * slope[0])
    return float(z[flat[0]] if flat.size else z_max)


def delta_sigma(f: Callable[[Array], Array], found: Identified) -> Array:
    """Standard deviation of f(parameters) by the delta method, central differences."""
    sigma = np.sqrt(np.diag(found.covariance))
    columns = []
    for i, s in enumerate(sigma):
        step = np.zeros_like(found.mean)
        step[i] = 0.1 * s
        columns.append((f(found.mean + step) - f(found.mean - step)) / (0.2 * s))
    J = np.stack(columns, axis=-1)
    return np.asarray(np.sqrt(np.einsum("...i,ij,...j->...", J, found.covariance, J)))


def difference_curve(
    vehicle: Vehicle, found: Identified, runs: list[RampRun], z_end: float
) -> DifferenceCurve:
    """D(eta) over the rising branch, up to ``z_end`` [1].

    The band is that of D at a given eta: the error of eta along the path counts as one of D.
    """
    p = path(vehicle, found.mean, np.linspace(0.0, z_end, ROWS))
    eta = np.linspace(1.0, float(p.eta[-1]), ROWS)
    D = np.interp(eta, p.eta, p.D)
    sigma = delta_sigma(lambda x: _at_eta(path(vehicle, x, p.z), eta), found)
    count = _count(eta, np.concatenate([_measured_eta(r, e) for r, e in _zeroed(runs, found)]))
    return DifferenceCurve(eta, D, D - 1.96 * sigma, D + 1.96 * sigma, count, _flags(count))


def paper_table(
    vehicle: Vehicle, found: Identified, runs: list[RampRun], z_end: float
) -> PaperCurves:
    """f1(eta) and f2(eta) of Fig. 6 from D, at the load split of the ramp's z; (18) is exact."""
    p = path(vehicle, found.mean, np.linspace(0.0, z_end, ROWS))
    d = difference_curve(vehicle, found, runs, z_end)
    z = np.interp(d.eta, p.eta, p.z)
    f1, f2 = paper_curves(vehicle, z, d.D)
    f1_a, f2_a = paper_curves(vehicle, z, d.lower)
    f1_b, f2_b = paper_curves(vehicle, z, d.upper)
    return PaperCurves(d.eta, z, f1, f1_a, f1_b, f2, f2_b, f2_a, d.count, d.flag)


def tyre_curve(vehicle: Vehicle, found: Identified, runs: list[RampRun], z_max: float) -> TyreCurve:
    """Normalised force over slip with half the weight on the axle, up to the greatest F seen."""
    top = path(vehicle, found.mean, np.asarray([z_max]))
    greatest = 1.1 * float(max(top.F_f[0], top.F_r[0]))
    force = np.linspace(0.0, 1.3 * greatest, 2 * ROWS)  # beyond the end, where the band needs it
    one = np.ones(())

    def slip(parameters: Array) -> Array:
        return Tyre(*parameters[:4]).slip(force, one)

    end = float(Tyre(*found.mean[:4]).slip(np.asarray(greatest), one))
    grid = np.linspace(0.0, end, ROWS)
    g = np.interp(grid, slip(found.mean), force)
    sigma = delta_sigma(lambda x: np.interp(grid, slip(x), force), found)
    seen = [
        np.concatenate([p.slip_f, p.slip_r])
        for p in (path(vehicle, found.mean, r.blocks.z[r.use]) for r in runs)
    ]
    count = _count(grid, np.concatenate(seen))
    return TyreCurve(grid, g, g - 1.96 * sigma, g + 1.96 * sigma, count, _flags(count))


def _at_eta(p: Path, eta: Array) -> Array:
    top = int(np.argmax(p.eta)) + 1
    return np.interp(eta, p.eta[:top], p.D[:top])


def _zeroed(runs: list[RampRun], found: Identified) -> list[tuple[RampRun, Array]]:
    return [
        (run, run.blocks.eta / (1.0 + zero)) for run, zero in zip(runs, found.eta_zero, strict=True)
    ]


def _measured_eta(run: RampRun, eta: Array) -> Array:
    return np.asarray(eta[run.use & ~run.blocks.lead_in])


def _count(grid: Array, seen: Array) -> Array:
    """How many of ``seen`` lie within one and a half rows of each row of the grid."""
    reach = 1.5 * (grid[1] - grid[0])
    ordered = np.sort(seen)
    above = np.searchsorted(ordered, grid + reach)
    below = np.searchsorted(ordered, grid - reach)
    return np.asarray(above - below, dtype=float)


def _flags(count: Array) -> Array:
    measured = count >= MIN_COUNT
    flags = np.full(count.size, EXTRAPOLATED)
    if measured.any():
        first, last = np.flatnonzero(measured)[[0, -1]]
        flags[first : last + 1] = INTERPOLATED
        flags[: first + 1] = INTERPOLATED  # D(1) = 0 is known
    flags[measured] = MEASURED
    return flags
