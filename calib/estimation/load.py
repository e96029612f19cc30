"""What a load that nobody stated leaves open of the pads, in the intervals of an estimate.

    upper end of ln mu of an axle:   variance + 2 E[m^2]   less what the mass is known to

A car that is heavier by the share m brakes less at one pressure, so its pads seem weaker by m, and
those of the rear axle by more where the load lies behind. Pads repeat from run to run, or have
changed, or somebody sits in the car, or both: the brakes of the stop over those of the ramp weigh
them. m is zero where nobody does. The lower end stays. As in `calib.estimation.motor` what is rare
and large has its 2.5 % further away than 1.96 times the root of its mean square; hence the 2. Uses
the whole run.

Nothing is left open where the mass of the run was stated. A load that was in the car on the ramp
and is not in the stop is not weighed.
"""

import math
from dataclasses import replace

import numpy as np

from calib.base.mixtures import log_likelihood_ratio, mean_square
from calib.estimation.estimator import Estimate
from calib.estimation.pads import grown, raised
from calib.estimation.settings import SETTINGS
from calib.estimation.warnings import pads_together

LOADS, USUAL = 0.1, 0.06
"""Share of the stops with a load that nobody stated, and its spread over the car's mass [1]: one
passenger of 75 kg to two, in cars of 1.2 to 2 t (our estimate)."""


CHANGED, CHANGE = 0.2, 0.3
"""Share of the stops whose pads have changed, wet or hot, and how far (logarithm)."""


def with_load(e: Estimate, *, stated: bool) -> Estimate:
    """The estimate, its intervals with a load that nobody stated.

    ``stated`` whether the mass of this run was. As it is without a valid sample. What is valid
    stays so: a sample that would tell the pads of the car as stated is still of use.
    """
    if stated or e.basis is None or not e.valid.any():
        return e
    square = mean_square_of_load(*pads_together(e, e.basis))
    more_open = max(2.0 * square - e.plan.nominal.mass_tolerance**2, 0.0)
    one = np.full(e.time.size, more_open)
    front, rear = raised(e.front, one), raised(e.rear, SETTINGS.load_behind * one)
    load = (grown(front, e.front), grown(rear, e.rear))
    return replace(e, front=front, rear=rear, load=load)


def mean_square_of_load(level: float, sigma: float) -> float:
    """Mean of the square of a load's share of the mass [1], where none counts as zero.

    ``level`` ln of the brake force over that of the ramp's pads, with its ``sigma``. Pads that have
    changed by more than a load makes them seem to hide one: it is then as likely as before.

    >>> [round(mean_square_of_load(level, 0.015) ** 0.5, 3) for level in (0.0, -0.05, -0.3)]
    [0.005, 0.027, 0.019]
    """
    usual = math.hypot(sigma, SETTINGS.pads_repeat)
    wide = math.hypot(usual, CHANGE)
    alike = log_likelihood_ratio(-level, usual, USUAL)
    changed = math.log(usual / wide) + 0.5 * level**2 * (usual**-2.0 - wide**-2.0)
    # nobody, somebody with the pads of the ramp, and both with pads that have changed
    logs = np.array([0.0, alike, changed, changed])
    odds = np.array([1.0 - LOADS, LOADS, 1.0 - LOADS, LOADS])
    odds *= (1.0 - CHANGED, 1.0 - CHANGED, CHANGED, CHANGED)
    weights = odds * np.exp(logs - logs.max())
    squares = np.array([0.0, mean_square(-level, usual, USUAL), 0.0, USUAL**2])
    return float(weights @ squares / weights.sum())
