"""From level and ratio to the pad friction of each axle, its interval, torque and force."""

import numpy as np
from numpy.typing import NDArray

from calib.estimation.axle_estimate import AxleEstimate
from calib.estimation.balance import BrakeBalance, smoothed
from calib.estimation.pad_level import PadLevel
from calib.estimation.pad_ratio import PadRatio
from calib.estimation.plan import Plan
from calib.physics.balance import brake_forces
from calib.signals.axle_signals import Signals
from calib.signals.blocks import Blocks
from calib.statistics.intervals import Z95
from calib.statistics.mixture_posterior import mixture_posterior

Array = NDArray[np.float64]


def estimate_axles(
    plan: Plan,
    s: Signals,
    sigma_z: Array,
    forces: BrakeBalance,
    level: PadLevel,
    answer: PadRatio,
    b: Blocks,
) -> tuple[AxleEstimate, AxleEstimate]:
    """Level and ratio to pad friction, torque and normalised force of each axle.

    ``sigma_z`` of the deceleration that the accelerometer leaves open [1], (n,).
    """
    car = plan.nominal
    at = np.searchsorted(b.end, s.time, side="right") - 1  # the last complete block
    rho, sigma = _held(answer.log_pad_ratio, at), _held(answer.sigma, at)
    theta, sigma_level = _level_weighed(plan, s, sigma_z, level)
    B_f, B_r = brake_forces(car, np.maximum(s.p_f, 1.0), np.maximum(s.p_r, 1.0))
    phi_0 = B_f / (B_f + B_r)
    half = np.exp(0.5 * rho)
    phi = B_f * half / (B_f * half + B_r / half)
    out = []
    road = forces.balance
    for axle, p, share, share_0, lever, moment, load in (
        (car.front, s.p_f, phi, phi_0, 1.0 - phi, road.moment_f, road.load_f),
        (car.rear, s.p_r, 1.0 - phi, 1.0 - phi_0, phi, road.moment_r, road.load_r),
    ):
        mu = axle.pad_friction * theta * share / share_0
        # d ln(share)/d rho is the other axle's share; a factor of e^5 either way is no answer
        spread = np.minimum(Z95 * np.sqrt(sigma_level**2 + (lever * sigma) ** 2), 5.0)
        torque = mu * axle.torque_gain * np.maximum(p, 0.0)
        brake = 2.0 * torque / axle.rolling_radius
        F = (np.nan_to_num(brake) + moment) / smoothed(s, load, plan.priors)
        out.append(AxleEstimate(mu, mu * np.exp(-spread), mu * np.exp(spread), torque, F))
    return out[0], out[1]


def _held(values: Array, at: NDArray[np.int64]) -> Array:
    """Each block's value from the sample on at which the block is complete."""
    return np.where(at >= 0, values[np.maximum(at, 0)], values[0])


def _level_weighed(plan: Plan, s: Signals, sigma_z: Array, level: PadLevel) -> tuple[Array, Array]:
    """Level and its relative sigma with mass and resistance counted, weighed against nominal.

    On a dry road the level is nominal within its error and stays there: compensation does no harm.
    Before the pads first bite nothing is known of them: nominal, as uncertain as pads are. Between
    brakings the last level stands, as uncertain again.
    """
    p = plan.priors
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.maximum(smoothed(s, s.z, p), 0.02)
        resist = np.hypot(plan.known.sigma_z(plan.nominal, s.speed), sigma_z) / z
        # a level of zero is as good as unknown: ten times everything
        noise = np.minimum(np.abs(level.sigma / level.value), 10.0)
        sigma = np.sqrt(noise**2 + resist**2 + plan.nominal.mass_tolerance**2)
        free = np.log(np.where(level.value > 0.0, level.value, np.nan))
    posterior = mixture_posterior(free, sigma, p.level_free, p.level_odds, p.level_alike)
    known = np.isfinite(posterior.mean)
    last = np.maximum.accumulate(np.where(known, np.arange(known.size), -1))
    held = np.where(last >= 0, posterior.mean[np.maximum(last, 0)], 0.0)
    return np.exp(held), np.where(known, posterior.sigma, p.level_free)
