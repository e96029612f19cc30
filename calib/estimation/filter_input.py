"""What the split filter reads of each block, as plain numbers: inputs, measurements and noise."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.names import G
from calib.car.braking import MOVING
from calib.car.vehicle import Vehicle
from calib.estimation.block_level import pressure_moves
from calib.estimation.measurement import Given
from calib.estimation.priors import Priors
from calib.estimation.states import AT, state_list
from calib.run.blocks import Blocks
from calib.run.filters import low_pass
from calib.run.noise import SensorNoise

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class SplitInput:
    """What the filter is given of each block besides the sensors, shapes (k,).

    ``nominal_f``, ``nominal_r`` brake forces of nominal pads [N]; ``level`` common factor on them
    (NaN: not braked) with its relative ``level_error`` [1]; ``moment_f``, ``moment_r`` other forces
    at the road [N], of which ``drive_f``, ``drive_r`` are those of engine or motor; ``load_f``,
    ``load_r`` [N]; ``tyre_sum`` all tyre forces [N]; ``slip`` measured mean slip [1] or None;
    ``pitch_deficit`` load that the pitch mode has not yet moved, over the weight [1], and
    ``pitch_slope`` its slope by the logarithm of the mode's frequency; ``rise`` rate of the brake
    force of nominal pads [N/s]; ``odds_by_level`` factor on the odds that the pads have the ratio
    of the ramp, `calib.estimation.odds_by_level` [1].
    """

    nominal_f: Array
    nominal_r: Array
    level: Array
    level_error: Array
    moment_f: Array
    moment_r: Array
    drive_f: Array
    drive_r: Array
    load_f: Array
    load_r: Array
    tyre_sum: Array
    slip: Array | None
    pitch_deficit: Array
    pitch_slope: Array
    rise: Array
    odds_by_level: Array


class Measured(NamedTuple):
    """What the sensors say of one block, and how well. Flags are 1.0 or 0.0.

    ``eta``, ``slip`` [1], NaN where not measured; ``variance_eta``, ``variance_slip`` from the
    sensors; ``relative`` error of both in proportion to the slip; ``known`` the brakes act or they
    do not, the car moves and all wheels roll; ``calm`` the body is at rest on its springs.
    """

    eta: float
    slip: float
    variance_eta: float
    variance_slip: float
    relative: float
    known: float
    calm: float


def given(vehicle: Vehicle, b: Blocks, d: SplitInput) -> list[list[float]]:
    """Inputs of the measurement equations, for each block in the order of `Given`.

    What slows a coasting car besides its drive is shared by all tyres as the weight is.
    """
    shared = (d.tyre_sum - d.drive_f - d.drive_r) / vehicle.weight
    columns = Given[Array](
        brake_f=d.nominal_f,
        brake_r=d.nominal_r,
        level=np.nan_to_num(d.level),
        moment_f=d.moment_f,
        moment_r=d.moment_r,
        load_f=d.load_f,
        load_r=d.load_r,
        coasting_f=shared + d.drive_f / d.load_f,
        coasting_r=shared + d.drive_r / d.load_r,
        weight=np.full(b.end.size, vehicle.weight),
        pitch_deficit=d.pitch_deficit,
        pitch_slope=d.pitch_slope,
        lag_gain=G * b.z / np.maximum(b.speed, 1.0),
        static_f=np.full(b.end.size, vehicle.static_loads[0]),
        static_r=np.full(b.end.size, vehicle.static_loads[1]),
        rise=d.rise,
    )
    rows: list[list[float]] = np.column_stack(columns).tolist()
    return rows


def measured(b: Blocks, d: SplitInput, noise: SensorNoise, priors: Priors) -> list[Measured]:
    """Measurements and their noise, block by block; T is the length of a block.

    ::

        variance    of the sensors                        in proportion to the slip
        eta         2 omega^2/(w^2 T)                     (relative (eta - 1 - eta_zero))^2
        slip        omega^2/(w^2 T) + v^2/(V^2 T)         (relative (slip - slip_zero))^2
        relative    model error + pressure and wheels apart in time while the pressure moves,
                and the error of the level; all of it lasts, `lasting_error`

    Between the lead-in and the bite, and after a release, nobody knows whether the pads touch: such
    a block says nothing.
    """
    braked = np.isfinite(d.level)
    omega, speed = np.maximum(b.omega_f, 1.0), np.maximum(b.speed, 1.0)
    axle = noise.omega**2 / omega**2 / b.length
    relative = np.hypot(priors.model + priors.sync * pressure_moves(b), d.level_error)
    columns = {
        "eta": b.eta,
        "slip": np.full(b.end.size, np.nan) if d.slip is None else d.slip,
        "variance_eta": 2.0 * axle,
        "variance_slip": axle + noise.v**2 / speed**2 / b.length,
        "relative": np.where(braked, relative, priors.model),
        "known": (braked | b.lead_in) & (b.speed > MOVING) & _all_roll(b, d.slip, priors.rolling),
        "calm": _held_back(b, priors) < priors.change_calm,
    }
    rows = np.column_stack([columns[name] for name in Measured._fields])
    return [Measured(*row) for row in rows.tolist()]


def lasting_error(length: float, priors: Priors) -> float:
    """Factor [1] on an error that lasts for ``model_memory``, for blocks that count it as noise.

    White noise with this factor has, over a long time, the mean of a first-order process with rho
    of one block to the next: sqrt((1 + rho)/(1 - rho)) (Priestley, Spectral Analysis and Time
    Series, section 5.3).
    """
    rho = math.exp(-length / priors.model_memory)
    return math.sqrt((1.0 + rho) / (1.0 - rho))


def process_noise(vehicle: Vehicle, b: Blocks, priors: Priors) -> Array:
    """What every block adds to the variance of each state, shape (k, COUNT).

    The random walk of its row in `state_list`, of the zeros only as long as the car rolls, as in a
    fit; to ``load_shift`` what a first-order process with ``pitch_memory`` takes in afresh.
    """
    drift = np.array([row.drift for row in state_list(priors)])
    out = np.tile(drift**2 * b.length, (b.end.size, 1))
    for zero in (AT.eta_zero, AT.slip_zero):
        out[~b.lead_in, zero] = 0.0
    fresh = 1.0 - math.exp(-2.0 * b.length / priors.pitch_memory)
    transfer = vehicle.cg_height / vehicle.wheelbase
    out[:, AT.load_shift] = fresh * (priors.pitch * _held_back(b, priors) * transfer) ** 2
    return out


def _held_back(b: Blocks, priors: Priors) -> Array:
    """Deceleration [1] that a first-order filter of ``pitch_time`` has not followed yet."""
    return np.asarray(np.abs(b.z - low_pass(b.z, b.length, priors.pitch_time)))


def _all_roll(b: Blocks, slip: Array | None, most: float) -> Mask:
    """Blocks in which all wheels roll on the rising branch of their tyres."""
    ok = np.abs(b.eta - 1.0) < most
    return np.asarray(ok if slip is None else ok & (np.abs(slip) < most))
