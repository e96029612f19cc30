"""Explanations that the logs cannot tell apart, and the drive that would, pair by pair."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from calib.diagnosis.explanation.explanation import Explanation
from calib.diagnosis.undecided.separate import best_drives, own_of


@dataclass(frozen=True)
class Alike:
    """An explanation that was fitted: its effects, and the mean squared innovation it leaves."""

    names: tuple[str, ...]
    innovation: float


@dataclass(frozen=True)
class Pair:
    """Two explanations by their places in the set.

    ``apart`` is their distance in the calibration logs, and ``sigma`` that in ``drive``, the
    manoeuvre that tells them apart best; both over the noise, in sigma of all innovations.
    """

    one: int
    other: int
    apart: float
    drive: str
    sigma: float


@dataclass(frozen=True)
class Confusion:
    """The set, the best explanation first, with every pair of it."""

    explanations: tuple[Alike, ...]
    pairs: tuple[Pair, ...]

    def pair(self, i: int, j: int) -> Pair:
        """The pair of two explanations, in either order. Raises KeyError if i equals j."""
        return {frozenset((p.one, p.other)): p for p in self.pairs}[frozenset((i, j))]


def confusion_of(best: Explanation, like: Sequence[Explanation]) -> Confusion | None:
    """The best explanation with those that are ``like`` it; None if there are none."""
    if not like:
        return None
    members = (best, *like)
    pairs = []
    for i, j in combinations(range(len(members)), 2):
        one, other = members[i], members[j]
        rows = zip(one.innovations, other.innovations, strict=True)
        apart = float(np.sqrt(sum(float((a - b) @ (a - b)) for a, b in rows)))
        ((drive, sigma),) = best_drives(one, [own_of(other)])
        pairs.append(Pair(i, j, apart, drive, sigma))
    return Confusion(tuple(Alike(c.names, c.reduced) for c in members), tuple(pairs))
