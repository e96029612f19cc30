"""Whether the stops of one road agree: pad friction of those with like tyres and like pads.

    tile   basalt  asphalt                        a group ends where the next stop differs
     x       x     x xx       ln of stiffness     from its mean by more than both may err

The stiffness is that of the slip which the estimate found, over that of the ramp. Roads that tyres
cannot tell apart, such as two kinds of dry asphalt, are one road here. On different roads the table
errs differently. Pads that all brake less in one stop, as wet ones do, are not compared with dry
ones; that they do is told as `level_changed`.
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
    """Stops of one road with like pads: their names, the stiffness of their tyres over the ramp's.

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
    roads: tuple[_Road, ...] = ()

    @property
    def differ(self) -> bool:
        """Whether stops are too far apart to have the same pads: where the station warns."""
        spreads = {"repeatability_f": self.spread_f, "repeatability_r": self.spread_r}
        return any(x > bound(key, "warn_high") for key, x in spreads.items())


def agreement(results: Iterable[Validation]) -> Agreement | None:
    """Agreement of the stops; None where no two with an answer are of one road and like pads."""
    keys = ("pad_friction_f", "pad_friction_r", "pad_level")
    known = [r for r in results if None not in [r.figures[key] for key in keys]]
    pads = np.array([[r.figures[key] for key in keys] for r in known], dtype=float)
    if len(known) < 2:
        return None
    tyres = np.array([stiffness(r.estimate) for r in known])
    roads = [_road(known, pads, tyres, group) for group in _alike(pads[:, 2], tyres)]
    compared = [(r.spread_f, r.spread_r) for r in roads if r.spread_f is not None]
    if not compared:
        return None
    spreads = np.max(np.array(compared, dtype=float), axis=0).tolist()
    mean = pads[:, :2].mean(axis=0).tolist()
    return Agreement(mean[0], mean[1], spreads[0], spreads[1], tuple(roads))


def _alike(level: Array, tyres: Array) -> list[list[int]]:
    """Places of the stops of one road with like pads, the softest road first.

    ``level`` of the pads [1] (n,); ``tyres`` ln of their stiffness with its sigma (n, 2).
    """
    groups: list[list[int]] = []
    for i in np.argsort(tyres[:, 0], kind="stable").tolist():
        for group in groups:
            sigma = math.hypot(tyres[i, 1], math.sqrt(np.mean(tyres[group, 1] ** 2) / len(group)))
            same_road = tyres[i, 0] - np.mean(tyres[group, 0]) <= _APART * sigma
            if same_road and abs(math.log(level[i] / np.mean(level[group]))) < _OTHER_PADS:
                group.append(i)
                break
        else:
            groups.append([i])
    return groups


def _road(results: list[Validation], pads: Array, tyres: Array, group: list[int]) -> _Road:
    mean = pads[group, :2].mean(axis=0)
    spread = np.abs(pads[group, :2] / mean - 1.0).max(axis=0).tolist()
    return _Road(
        tuple(results[i].log for i in group),
        math.exp(np.mean(tyres[group, 0])),
        *mean.tolist(),
        *(spread if len(group) > 1 else (None, None)),
    )


def stiffness(e: Estimate) -> tuple[float, float]:
    """ln of the tyres' stiffness over that of the ramp [1] at the last telling sample; its sigma.

    Where no sample tells, it is that of the ramp, and may be any. Of a stop over two roads it is
    that of its end.
    """
    if not e.telling.any():
        return 0.0, _ANY_ROAD
    i, tyre = int(np.flatnonzero(e.telling)[-1]), e.plan.table.tyre
    z = min(max(float(e.z[i]), float(tyre.force[1])), float(tyre.force[-1]))
    on_ramp = float(np.interp(z, tyre.force, tyre.slip)) / z
    return math.log(on_ramp) - float(e.best.slip[i]), float(e.best.slip_sigma[i])
