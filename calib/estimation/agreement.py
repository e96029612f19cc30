"""Whether the stops of one road agree: pad friction of those with like tyres and like pads.

    tile   basalt  asphalt                        a road ends where a stop differs from its
     x       x     x xx       ln of stiffness     softest by more than both may err

Roads that tyres cannot tell apart are one road; on different ones a table errs differently. Pads
that all brake less in one stop, as wet ones do, are not compared with dry ones: `level_changed`
tells of them.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.plain import bound
from calib.estimation.estimator import Estimate
from calib.estimation.validate import Validation

_PADS = ("pad_friction_f", "pad_friction_r", "pad_level")
_APART = 2.5
"""Difference of two stiffnesses from which they are of two roads [sigma]: by chance in one pair of
eighty on the same road."""
_OTHER_PADS = 0.15
"""Difference of ln of the pad level [1] from which pads are not alike: that of one of the stops has
then changed since the ramp by more than goes without a warning."""


@dataclass(frozen=True)
class _Road:
    """Stops of one road with like pads: names, stiffness of the tyres over the ramp's [1].

    ``mean_f``, ``mean_r`` pad friction; ``spread_f``, ``spread_r`` the largest relative departure
    from it, the repeatability [1]; None of a single stop.
    """

    stops: tuple[str, ...]
    stiffness: float
    mean_f: float
    mean_r: float
    spread_f: float | None
    spread_r: float | None


@dataclass(frozen=True)
class Agreement:
    """Pad friction of the stops: the mean of all, and the largest departure within a road [1]."""

    roads: tuple[_Road, ...]
    mean_f: float
    mean_r: float
    spread_f: float
    spread_r: float

    @property
    def differ(self) -> bool:
        """Whether stops are too far apart to have the same pads: where the station warns."""
        front, rear = (bound(f"repeatability_{axle}", "warn_high") for axle in "fr")
        return self.spread_f > front or self.spread_r > rear


def agreement(results: Iterable[Validation]) -> Agreement | None:
    """Agreement of the stops; None where no two with an answer are of one road and like pads."""
    known = [r for r in results if r.figures["pad_level"] is not None]
    rows = [[*(r.figures[key] for key in _PADS), *stiffness(r.estimate)] for r in known]
    stops = np.array(rows, dtype=float).reshape(-1, 5)
    roads = tuple(_road([known[i].log for i in of], stops[of]) for of in _alike(*stops[:, 2:].T))
    spreads = [(r.spread_f, r.spread_r) for r in roads if len(r.stops) > 1]
    if not spreads:
        return None
    means, most = stops[:, :2].mean(axis=0), np.array(spreads, dtype=float).max(axis=0)
    return Agreement(roads, *means.tolist(), *most.tolist())


def stiffness(e: Estimate) -> tuple[float, float]:
    """ln of the tyres' stiffness over that of the ramp [1], by the slip of the last valid sample;
    its sigma.
    """
    i, tyre = int(np.flatnonzero(e.valid)[-1]), e.table.tyre
    z = float(np.clip(e.read.z[i], tyre.force[1], tyre.force[-1]))
    on_ramp = float(np.interp(z, tyre.force, tyre.slip)) / z
    return math.log(on_ramp) - float(e.best.step.slip[i]), float(e.best.step.slip_sigma[i])


def _alike(level: Array, tyres: Array, sigma: Array) -> list[list[int]]:
    """Places of the stops of each road with like pads, the softest road first.

    ``level`` of the pads, ln of the tyres' stiffness and its ``sigma``, (n,).
    """
    left, roads = np.argsort(tyres, kind="stable"), []
    while left.size:
        apart = (tyres[left] - tyres[left[0]]) / np.hypot(sigma[left], sigma[left[0]])
        other = np.abs(np.log(level[left] / level[left[0]])) >= _OTHER_PADS
        alike = (apart <= _APART) & ~other
        roads.append(left[alike].tolist())
        left = left[~alike]
    return roads


def _road(names: list[str], stops: Array) -> _Road:
    mean_f, mean_r, _, tyres, _ = stops.mean(axis=0).tolist()
    apart = np.abs(stops[:, :2] / (mean_f, mean_r) - 1.0).max(axis=0).tolist()
    spread = apart if len(names) > 1 else (None, None)
    return _Road(tuple(names), math.exp(tyres), mean_f, mean_r, *spread)
