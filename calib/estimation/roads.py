"""Which stops were made on one road: those whose tyres have the same stiffness.

    tile   basalt  asphalt                        a group ends where the next stop differs
     x       x     x xx       ln of stiffness     from its mean by more than both may err

A stop on which the surface changes is on a road of its own. Roads that the tyres cannot tell apart,
such as two kinds of dry asphalt, are one road here; so are the errors that a table makes on them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.estimation.estimator import Estimate
from calib.estimation.settings import SETTINGS


@dataclass(frozen=True)
class Road:
    """A road: places of its ``stops`` in the sequence, ``log_stiffness`` relative to the table [1].

    ``one`` is false for a stop on which the surface changes.
    """

    stops: tuple[int, ...]
    log_stiffness: float
    one: bool = True


def roads_of(estimates: Sequence[Estimate]) -> tuple[Road, ...]:
    """The roads of the stops, from the softest to the stiffest, changing ones last."""
    last = [(e.split.log_stiffness[-1], e.split.log_stiffness_sigma[-1]) for e in estimates]
    steady = [i for i, e in enumerate(estimates) if not e.split.changes]
    groups: list[list[int]] = []
    for i in sorted(steady, key=lambda i: float(last[i][0])):
        if groups and _alike(last[i], [last[j] for j in groups[-1]]):
            groups[-1].append(i)
        else:
            groups.append([i])
    changing = [i for i in range(len(estimates)) if i not in steady]
    return (
        *(Road(tuple(g), float(np.mean([last[i][0] for i in g]))) for g in groups),
        *(Road((i,), float(last[i][0]), one=False) for i in changing),
    )


def _alike(stop: tuple[float, float], group: list[tuple[float, float]]) -> bool:
    """Whether a stiffness (mean, sigma) is that of a group, none of which it is below."""
    mean = float(np.mean([value for value, _ in group]))
    variance = float(np.mean([sigma**2 for _, sigma in group])) / len(group)
    return bool(stop[0] - mean <= SETTINGS.roads_apart * np.sqrt(stop[1] ** 2 + variance))
