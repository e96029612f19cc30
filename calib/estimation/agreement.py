"""Compare the pad friction of the stops on one road.

    tile   basalt  asphalt                        a road: all stops whose stiffness differs from
     x       x     x xx       ln of stiffness     that of its softest stop by less than the errors

Stops are compared on one road only, since the error of a table depends on the road. The stiffness
of the tyres shows which stops are on one road. Wet pads are not compared with dry pads: the warning
`level_changed` names their difference.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from calib.base.plain import finite_or_none, limit_of
from calib.estimation.estimator import Estimate
from calib.estimation.validate import Validation

_FIGURES = ("pad_friction_f", "pad_friction_r", "pad_level")
_OTHER_ROAD = 2.5  # difference of stiffness that means two roads [sigma]: 1 of 80 pairs of one road
_OTHER_PADS = 0.15  # difference of ln of the level [1] that means other pads, as `level_changed`


@dataclass(frozen=True)
class _Road:
    """Stops on one road with like pads."""

    stops: tuple[str, ...]  # names
    stiffness: float  # of the tyres, over that on the ramp [1]
    mean_f: float  # mean pad friction [1]
    mean_r: float
    spread_f: float | None  # largest relative departure from `mean_f` [1]; None for a single stop
    spread_r: float | None


@dataclass(frozen=True)
class _Agreement:
    """Mean pad friction of all stops, and largest departure from the mean of a road [1]."""

    pad_friction_f: float
    pad_friction_r: float
    largest_departure_f: float
    largest_departure_r: float
    roads: tuple[_Road, ...]

    @property
    def differ(self) -> bool:
        """Whether stops are too far apart to have the same pads, by the limits of the station."""
        front, rear = (limit_of(f"repeatability_{axle}", "warn_high") for axle in "fr")
        return self.largest_departure_f > front or self.largest_departure_r > rear


def agreement(results: Iterable[Validation]) -> _Agreement | None:
    """Return the agreement of stops, None where no two with an answer share road and pads."""
    answered = [r for r in results if r.figures["pad_level"] is not None]
    rows = [[*(r.figures[key] for key in _FIGURES), *stiffness(r.estimate)] for r in answered]
    stops = np.array(rows, dtype=float).reshape(-1, 5)
    pads, (level, log_stiffness, sigma) = stops[:, :2], stops[:, 2:].T
    roads = []
    ungrouped = np.argsort(log_stiffness, kind="stable")
    while ungrouped.size:
        first = ungrouped[0]  # the softest stop without a road begins a road
        difference = log_stiffness[ungrouped] - log_stiffness[first]
        is_like = difference <= _OTHER_ROAD * np.hypot(sigma[ungrouped], sigma[first])
        is_like &= np.abs(np.log(level[ungrouped] / level[first])) < _OTHER_PADS
        group = ungrouped[is_like]
        mean = pads[group].mean(axis=0)
        spread = np.abs(pads[group] / mean - 1.0).max(axis=0) if len(group) > 1 else (None, None)
        names = tuple(answered[i].log for i in group)
        stiffness_ratio = math.exp(log_stiffness[group].mean())
        roads.append(_Road(names, stiffness_ratio, *mean.tolist(), *map(finite_or_none, spread)))
        ungrouped = ungrouped[~is_like]
    spreads = [(road.spread_f, road.spread_r) for road in roads if road.spread_f is not None]
    if not spreads:
        return None
    mean_f, mean_r = pads.mean(axis=0).tolist()
    largest_f, largest_r = np.array(spreads, dtype=float).max(axis=0).tolist()
    return _Agreement(mean_f, mean_r, largest_f, largest_r, tuple(roads))


def stiffness(e: Estimate) -> tuple[float, float]:
    """Return ln of tyre stiffness over the ramp's [1] at the last valid sample, and its sigma."""
    i, tyre, step = int(np.flatnonzero(e.valid)[-1]), e.table.tyre, e.best.step
    z = float(np.clip(e.signals.z[i], tyre.force[1], tyre.force[-1]))
    slip_per_z_on_ramp = float(np.interp(z, tyre.force, tyre.slip)) / z
    return math.log(slip_per_z_on_ramp) - float(step.slip[i]), float(step.slip_sigma[i])
