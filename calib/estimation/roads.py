"""Which stops were made on one road: those whose tyres have the same stiffness.

    tile   basalt  asphalt                        a group ends where the next stop differs
     x       x     x xx       ln of stiffness     from its mean by more than both may err

The slip that the step found, over that of the ramp at the same deceleration. Roads that the tyres
cannot tell apart, such as two kinds of dry asphalt, are one road here; so are the errors that a
table makes on them. A stop over two roads is taken by its end.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.estimation.estimator import Estimate
from calib.estimation.settings import SETTINGS


@dataclass(frozen=True)
class Road:
    """A road: places of its ``stops`` in the sequence, ``log_stiffness`` relative to the table."""

    stops: tuple[int, ...]
    log_stiffness: float


def roads_of(estimates: Sequence[Estimate]) -> tuple[Road, ...]:
    """The roads of the stops, from the softest to the stiffest."""
    last = [stiffness(e) for e in estimates]
    groups: list[list[int]] = []
    for i in sorted(range(len(last)), key=lambda i: last[i][0]):
        if groups and _alike(last[i], [last[j] for j in groups[-1]]):
            groups[-1].append(i)
        else:
            groups.append([i])
    return tuple(Road(tuple(g), float(np.mean([last[i][0] for i in g]))) for g in groups)


def stiffness(e: Estimate) -> tuple[float, float]:
    """ln of the tyres' stiffness over that of the ramp [1] at the last telling sample; its sigma.

    Where no sample tells, it is that of the ramp, and may be any.
    """
    if not e.telling.any():
        return 0.0, SETTINGS.any_road
    i, tyre = int(np.flatnonzero(e.telling)[-1]), e.plan.table.tyre
    z = min(max(float(e.z[i]), float(tyre.force[1])), float(tyre.force[-1]))
    on_ramp = float(np.interp(z, tyre.force, tyre.slip)) / z
    return math.log(on_ramp) - float(e.best.slip[i]), float(e.best.slip_sigma[i])


def _alike(stop: tuple[float, float], group: list[tuple[float, float]]) -> bool:
    """Whether a stiffness (mean, sigma) is that of a group, none of which it is below."""
    mean = float(np.mean([value for value, _ in group]))
    variance = float(np.mean([sigma**2 for _, sigma in group])) / len(group)
    return bool(stop[0] - mean <= SETTINGS.roads_apart * np.sqrt(stop[1] ** 2 + variance))
