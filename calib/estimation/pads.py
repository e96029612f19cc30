"""From level and ratio to the pad friction of each axle, its interval, torque and force."""

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import Z95
from calib.car.balance import brake_forces
from calib.estimation.axle_estimate import AxleEstimate
from calib.estimation.lookup import smoothed
from calib.estimation.pad_ratio import PadRatio
from calib.estimation.plan import Plan
from calib.estimation.weighed_level import WeighedLevel
from calib.run.axle_signals import Signals
from calib.run.blocks import Blocks
from calib.run.brake_response import BrakeBalance

Array = NDArray[np.float64]


def estimate_axles(
    plan: Plan,
    s: Signals,
    forces: BrakeBalance,
    level: WeighedLevel,
    answer: PadRatio,
    b: Blocks,
) -> tuple[AxleEstimate, AxleEstimate]:
    """Level and ratio to pad friction, torque and normalised force of each axle."""
    car = plan.nominal
    at = b.last_complete(s.time)
    rho, sigma = answer.log_pad_ratio[at], answer.sigma[at]
    theta = level.value
    B_f, B_r = brake_forces(car, np.maximum(s.p_f, 1.0), np.maximum(s.p_r, 1.0))
    phi_0 = B_f / (B_f + B_r)
    half = np.exp(0.5 * rho)
    phi = B_f * half / (B_f * half + B_r / half)
    total = theta * (B_f + B_r)
    changes = _changes(plan, s, total, level.sigma, answer, at)
    out = []
    road = forces.balance
    for axle, p, share, share_0, lever, moment, load, (change, change_sigma) in (
        (car.front, s.p_f, phi, phi_0, 1.0 - phi, road.moment_f, road.load_f, changes[0]),
        (car.rear, s.p_r, 1.0 - phi, 1.0 - phi_0, phi, road.moment_r, road.load_r, changes[1]),
    ):
        mu = axle.pad_friction * theta * share / share_0
        # d ln(share)/d rho is the other axle's share
        spread = _half_width(np.hypot(level.absolute, lever * sigma))
        apart = _half_width(change_sigma)
        torque = mu * axle.torque_gain * np.maximum(p, 0.0)
        brake = 2.0 * torque / axle.rolling_radius
        F = (np.nan_to_num(brake) + moment) / smoothed(s, load, plan.priors)
        out.append(
            AxleEstimate(
                pad_friction=mu,
                lower=mu * np.exp(-spread),
                upper=mu * np.exp(spread),
                torque=torque,
                normalised_force=F,
                change=change,
                change_lower=change * np.exp(-apart),
                change_upper=change * np.exp(apart),
            )
        )
    return out[0], out[1]


def _half_width(sigma: Array) -> Array:
    """Half width of the 95 % interval of a logarithm; a factor of e^5 either way is no answer."""
    return np.minimum(Z95 * sigma, 5.0)


def _changes(
    plan: Plan,
    s: Signals,
    total: Array,
    sigma_level: Array,
    answer: PadRatio,
    at: NDArray[np.int64],
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Pad friction of each axle over that of the calibration, and the sigma of its logarithm.

    ``total`` brake force of both axles [N] (n,). The tyres, the radii under load and the pads'
    ratio of the ramp are those of today and fall out.
    """
    cal, car = plan.table.calibration, plan.table.vehicle
    p_f, p_r = np.maximum(s.p_f, 1.0), np.maximum(s.p_r, 1.0)
    rho, change = cal.pad_log_ratio.value, answer.change[at]
    x, y = brake_forces(car, p_f, p_r, rho + change)
    share = x / (x + y)
    level = _level_change_sigma(plan, sigma_level)
    sigma = answer.change_sigma[at]
    then_f, then_r = (cal.pad_scale.value * B for B in brake_forces(car, p_f, p_r, rho))
    return (
        (total * share / then_f, np.hypot(level, (1.0 - share) * sigma)),
        (total * (1.0 - share) / then_r, np.hypot(level, share * sigma)),
    )


def _level_change_sigma(plan: Plan, sigma_level: Array) -> Array:
    """Sigma of the logarithm of the level over that of the ramp [1] (n,).

    ``sigma_level`` of the level against nominal pads. The error of the mass does not fall out,
    since the load may be another one. It counts once where both masses are that of the file, and
    once more where that of today was stated: then they were found apart.
    """
    scale, car = plan.table.calibration.pad_scale, plan.table.vehicle
    common = 0.0 if plan.mass_stated else car.mass_tolerance
    ramp = scale.sigma / scale.value
    return np.sqrt(sigma_level**2 + max(ramp**2 - common**2, 0.0))
