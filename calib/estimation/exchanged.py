"""What a log would say if front and rear wheel speeds were exchanged in it."""

from dataclasses import dataclass, replace

import numpy as np

from calib.car.forces import mean_slip
from calib.car.vehicle import Vehicle
from calib.estimation.estimator import Basis, Estimate, split_of
from calib.estimation.filter_input import SplitInput
from calib.run.blocks import Blocks

SETTLED = -15.0
"""Log odds of an exchange at which the axles are right, whatever comes later: with exchanged ones
they do not fall so far (`tests/studies/results/swapped_stops.md`), and on a road that changes
abruptly the odds speak of the road."""


@dataclass(frozen=True)
class Exchanged:
    """The log with its axles exchanged against the log as it is, at the end of its braking.

    ``log_odds`` logarithm of the density of all that was measured, exchanged over as given [1]:
    both explanations know the table, and pads that are its own or not. The least on the way, where
    that is below `SETTLED`. ``log_pad_ratio`` what the log as given says of the pads [1], and what
    it says exchanged; ``block`` at which.
    """

    log_odds: float
    block: int
    log_pad_ratio: tuple[float, float]


def exchanged(e: Estimate, basis: Basis) -> Exchanged:
    """Run the split filter once more, with the wheel speeds of the axles exchanged.

    The level of the pads does not hang on which axle is which, and is kept.
    """
    b, demand = _other_way(e.plan.nominal, e.blocks, basis.demand)
    other = split_of(e.plan, b, demand)
    braked = np.flatnonzero(np.isfinite(demand.level))
    last = int(braked[-1]) if braked.size else b.end.size - 1
    odds = other.evidence - e.split.evidence
    least = float(np.min(odds[: last + 1]))
    return Exchanged(
        log_odds=least if least < SETTLED else float(odds[last]),
        block=last,
        log_pad_ratio=(float(e.split.log_pad_ratio[last]), float(other.log_pad_ratio[last])),
    )


def _other_way(car: Vehicle, b: Blocks, demand: SplitInput) -> tuple[Blocks, SplitInput]:
    """Blocks with the wheel speeds exchanged, and the mean slip that they show then."""
    b = replace(b, omega_f=b.omega_r, omega_r=b.omega_f)
    if b.v is None:
        return b, demand
    slip = mean_slip(car, demand.load_f, b.omega_f, b.omega_r, b.v)
    return b, replace(demand, slip=slip)
