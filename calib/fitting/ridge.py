"""The ramps as the draws of an ensemble have them, over z: forces, eta, and where eta turns.

    z --(pads, loads)--> F_f, F_r --tyres--> eta          D = F_f - F_r          of every draw

Quasi-steady, without drag, one master-cylinder pressure for both axles.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.balance import braked_tyres, turning_shares
from calib.car.bias import front_share
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, shown
from calib.model.settings import SETTINGS

_SURE = 0.00135
"""Share of the draws in which eta must go on rising for its peak to be doubted: 3 sigma."""


@dataclass(frozen=True)
class Ridge:
    """``z`` (k,); of every draw (n, k): ``eta``, normalised forces ``F_f``, ``F_r``, slips of the
    tyres ``slip_f``, ``slip_r``. All [1].
    """

    z: Array
    eta: Array
    F_f: Array
    F_r: Array
    slip_f: Array
    slip_r: Array

    @property
    def D(self) -> Array:
        """F_f - F_r, (n, k)."""
        return self.F_f - self.F_r

    @property
    def middle(self) -> Array:
        """Median of eta, (k,)."""
        return np.asarray(np.median(self.eta, axis=0))


def ridge(car: Vehicle, e: Ensemble, z: Array) -> Ridge:
    """The draws over ``z`` (k,) [1]. Forces are over the loads that the vehicle file gives."""
    brake = z * (1.0 + sum(turning_shares(car)))
    front, rear = braked_tyres(car, front_share(car, e.log_pad_ratio)[:, None], brake, z)
    of = shown(car, e, z, np.stack([front, rear]))
    load_f, load_r = (load / car.weight for load in axle_loads(car, z))
    return Ridge(z, 1.0 + of.rise, front / load_f, rear / load_r, *of.slips)


@dataclass(frozen=True)
class Peak:
    """Where eta turns on the ramp: ``z``, ``eta`` [1]; ``real`` if it surely falls after it."""

    z: float
    eta: float
    real: bool


def find_peak(of: Ridge) -> Peak:
    """Test whether eta peaks inside the range of a ridge."""
    top = int(np.argmax(of.middle))
    falls = np.quantile(of.eta[:, top] - of.eta[:, -1], _SURE) > 0.0
    return Peak(float(of.z[top]), float(of.middle[top]), bool(falls))


def readable_up_to(of: Ridge) -> float:
    """Greatest z [1] up to which eta rises steeply enough that f1 and f2 can be read from it."""
    slope = np.diff(of.middle)
    flat = np.flatnonzero(slope < SETTINGS.flat * slope[0])
    return float(of.z[flat[0]] if flat.size else of.z[-1])
