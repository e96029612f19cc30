"""Whether the stops on one road agree on the pad friction.

    tile   basalt  asphalt                        a road: all stops that differ in stiffness from
     x       x     x xx       ln of stiffness     its softest stop by less than their errors

A road is told by the stiffness of the tyres, since the error of a table depends on the road. Wet
pads are not compared with dry ones: `level_changed` warns of them.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from calib.base.plain import finite_or_none, limit_of
from calib.estimation.estimator import Estimate
from calib.estimation.validate import Validation

_PADS = ("pad_friction_f", "pad_friction_r", "pad_level")
_OTHER_ROAD = 2.5  # difference of stiffness of two roads [sigma]; one road: 1 of 80 pairs
_OTHER_PADS = 0.15  # difference of ln of the level [1] at which one of two stops has a warning


@dataclass(frozen=True)
class _Road:
    """Stops on one road with like pads; ``stiffness`` of the tyres over the ramp's [1].

    ``mean_f``, ``mean_r`` pad friction; ``spread_f``, ``spread_r`` the largest relative departure
    from it [1], None of a single stop.
    """

    stops: tuple[str, ...]
    stiffness: float
    mean_f: float
    mean_r: float
    spread_f: float | None
    spread_r: float | None


@dataclass(frozen=True)
class _Agreement:
    """Mean pad friction of all stops, and the largest departure from it within a road [1]."""

    pad_friction_f: float
    pad_friction_r: float
    largest_departure_f: float
    largest_departure_r: float
    roads: tuple[_Road, ...]

    @property
    def differ(self) -> bool:
        """Whether stops are too far apart to have the same pads: where the station warns."""
        front, rear = (limit_of(f"repeatability_{axle}", "warn_high") for axle in "fr")
        return self.largest_departure_f > front or self.largest_departure_r > rear


def agreement(results: Iterable[Validation]) -> _Agreement | None:
    """Agreement of the stops; None where no two with an answer are of one road and like pads.

    The softest stop without a road begins one, which has all stops that are like it.
    """
    answered = [r for r in results if r.figures["pad_level"] is not None]
    rows = [[*(r.figures[key] for key in _PADS), *stiffness(r.estimate)] for r in answered]
    stops = np.array(rows, dtype=float).reshape(-1, 5)
    ungrouped, roads = np.argsort(stops[:, 3], kind="stable"), []
    while ungrouped.size:
        _, _, level, tyres, sigma = stops[ungrouped].T
        like = tyres - tyres[0] <= _OTHER_ROAD * np.hypot(sigma, sigma[0])
        like &= np.abs(np.log(level / level[0])) < _OTHER_PADS
        group = stops[ungrouped[like]]
        pads = group[:, :2].mean(axis=0)
        spread = np.abs(group[:, :2] / pads - 1.0).max(axis=0) if len(group) > 1 else (None, None)
        names = tuple(answered[i].log for i in ungrouped[like])
        roads.append(
            _Road(names, math.exp(group[:, 3].mean()), *pads.tolist(), *map(finite_or_none, spread))
        )
        ungrouped = ungrouped[~like]
    spreads = [(road.spread_f, road.spread_r) for road in roads if road.spread_f is not None]
    if not spreads:
        return None
    means, most = stops[:, :2].mean(axis=0), np.array(spreads, dtype=float).max(axis=0)
    return _Agreement(
        float(means[0]), float(means[1]), float(most[0]), float(most[1]), tuple(roads)
    )


def stiffness(e: Estimate) -> tuple[float, float]:
    """ln of the tyres' stiffness over the ramp's [1], at the last valid sample, and its sigma."""
    i, tyre = int(np.flatnonzero(e.valid)[-1]), e.table.tyre
    z = float(np.clip(e.read.z[i], tyre.force[1], tyre.force[-1]))
    on_ramp = float(np.interp(z, tyre.force, tyre.slip)) / z
    return math.log(on_ramp) - float(e.best.step.slip[i]), float(e.best.step.slip_sigma[i])
