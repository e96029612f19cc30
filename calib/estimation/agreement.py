"""Whether the stops of one road agree: pad friction of those with like tyres and like pads.

    tile   basalt  asphalt                        a road ends where the next stop differs
     x       x     x xx       ln of stiffness     from its mean by more than both may err

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

_APART = 2.5
"""Difference of two stiffnesses from which they are of two roads [sigma]: by chance in one pair of
eighty on the same road."""
_ANY_ROAD = 0.35
"""Sigma of ln of the stiffness of a road of which nothing is known [1]: tile to dry asphalt spans
factors of 0.6 to 1.1."""
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

    mean_f: float
    mean_r: float
    spread_f: float
    spread_r: float
    roads: tuple[_Road, ...]

    @property
    def differ(self) -> bool:
        """Whether stops are too far apart to have the same pads: where the station warns."""
        front, rear = (bound(f"repeatability_{axle}", "warn_high") for axle in "fr")
        return self.spread_f > front or self.spread_r > rear


def agreement(results: Iterable[Validation]) -> Agreement | None:
    """Agreement of the stops; None where no two with an answer are of one road and like pads."""
    keys = ("pad_friction_f", "pad_friction_r", "pad_level")
    known = [r for r in results if None not in [r.figures[key] for key in keys]]
    found = [[*(r.figures[key] for key in keys), *stiffness(r.estimate)] for r in known]
    stops = np.array(found, dtype=float).reshape(-1, 5)
    roads = tuple(_road([known[i].log for i in of], stops[of]) for of in _alike(stops[:, 2:]))
    spreads = [(r.spread_f, r.spread_r) for r in roads if len(r.stops) > 1]
    if not spreads:
        return None
    (mean_f, mean_r), (f, r) = stops[:, :2].mean(axis=0), np.array(spreads, float).max(axis=0)
    return Agreement(float(mean_f), float(mean_r), float(f), float(r), roads)


def stiffness(e: Estimate) -> tuple[float, float]:
    """ln of the tyres' stiffness over that of the ramp [1] at the last telling sample; its sigma.

    By the slip of the estimate; nothing is known where no sample tells.
    """
    if not e.telling.any():
        return 0.0, _ANY_ROAD
    i, tyre = int(np.flatnonzero(e.telling)[-1]), e.table.tyre
    z = min(max(float(e.read.z[i]), float(tyre.force[1])), float(tyre.force[-1]))
    on_ramp = float(np.interp(z, tyre.force, tyre.slip)) / z
    return math.log(on_ramp) - float(e.best.step.slip[i]), float(e.best.step.slip_sigma[i])


def _alike(stops: Array) -> list[list[int]]:
    """Places of the stops of one road with like pads, the softest road first.

    ``stops`` level of the pads, ln of the tyres' stiffness and its sigma (n, 3).
    """
    groups: list[list[int]] = []
    for i in np.argsort(stops[:, 1], kind="stable").tolist():
        level, tyres, sigma = stops[i]
        for group in groups:
            levels, others, sigmas = stops[group].T
            error = math.hypot(sigma, math.sqrt(np.mean(sigmas**2) / len(group)))
            same_road = tyres - np.mean(others) <= _APART * error
            if same_road and abs(math.log(level / np.mean(levels))) < _OTHER_PADS:
                group.append(i)
                break
        else:
            groups.append([i])
    return groups


def _road(names: list[str], stops: Array) -> _Road:
    mean_f, mean_r = stops[:, :2].mean(axis=0).tolist()
    f, r = (
        np.abs(stops[:, :2] / (mean_f, mean_r) - 1.0).max(axis=0).tolist()
        if len(names) > 1
        else (None, None)
    )
    return _Road(tuple(names), math.exp(np.mean(stops[:, 3])), mean_f, mean_r, f, r)
