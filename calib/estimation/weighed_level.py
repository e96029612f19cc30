"""The level of the pads as the answer has it: weighed against nominal, and what it leaves open."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.mixtures import mixture_posterior
from calib.estimation.pad_level import PadLevel
from calib.estimation.plan import Plan

Array = NDArray[np.float64]


@dataclass(frozen=True)
class WeighedLevel:
    """Common factor on the nominal pads, and the causes of its uncertainty. Shapes (n,), all [1].

    ``value`` of the factor; ``sigma`` of its logarithm against the nominal pads; ``absolute`` the
    same with what is open of the nominal pads themselves; ``nominal_weight`` that the pads have the
    nominal level, 0 where nothing is known; ``free`` logarithm of the level as measured, with its
    error ``measured``. That is made of ``noise``, ``resistance``, ``accelerometer`` and the mass,
    each a standard deviation relative to the level.
    """

    value: Array
    sigma: Array
    absolute: Array
    nominal_weight: Array
    free: Array
    measured: Array
    noise: Array
    resistance: Array
    accelerometer: Array


def weigh_level(
    plan: Plan, speed: Array, z: Array, sigma_z: Array, level: PadLevel
) -> WeighedLevel:
    """Level with mass, resistance and accelerometer counted, weighed against nominal.

    On a dry road the level is nominal within its error and stays there: compensation does no harm.
    Nominal pads are those of the ramp, known as well as the ramp tells them; pads that the user
    gives are taken as exact. Before the pads first bite nothing is known of them: nominal, as
    uncertain as pads are. Between brakings the last level stands, as uncertain again.

    ``speed`` [m/s]; ``z`` smoothed [1]; ``sigma_z`` what the accelerometer leaves open of it [1].
    """
    p = plan.priors
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.maximum(z, 0.02)
        resistance, accelerometer = plan.known.sigma_z(plan.nominal, speed) / z, sigma_z / z
        # a level of zero is as good as unknown: ten times everything
        noise = np.minimum(np.abs(level.sigma / level.value), 10.0)
        mass = plan.nominal.mass_tolerance
        sigma = np.sqrt(noise**2 + resistance**2 + accelerometer**2 + mass**2)
        free = np.log(np.where(level.value > 0.0, level.value, np.nan))
    posterior = mixture_posterior(free, sigma, p.level_free, p.level_odds, p.level_alike)
    known = np.isfinite(posterior.mean)
    last = np.maximum.accumulate(np.where(known, np.arange(known.size), -1))
    held = np.where(last >= 0, posterior.mean[np.maximum(last, 0)], 0.0)
    against_nominal = np.where(known, posterior.sigma, p.level_free)
    weight = np.where(known, posterior.nominal_weight, 0.0)
    return WeighedLevel(
        value=np.exp(held),
        sigma=against_nominal,
        absolute=np.sqrt(against_nominal**2 + weight * sum(plan.ramp_level.values())),
        nominal_weight=weight,
        free=free,
        measured=sigma,
        noise=noise,
        resistance=resistance,
        accelerometer=accelerometer,
    )
