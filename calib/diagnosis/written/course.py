"""The course of a search: what each step added, what that brought, and what it left."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from calib.diagnosis.search.search import SearchStep


@dataclass(frozen=True)
class Change:
    """One step of the search against the step before.

    ``gain`` is the fall of the mean squared innovation of the calibration logs, negative where it
    grows.
    """

    added: tuple[str, ...]
    removed: tuple[str, ...]
    gain: float
    step: SearchStep


def changes(steps: Sequence[SearchStep]) -> list[Change]:
    """What each step after the first one changed."""
    return [
        Change(
            added=tuple(name for name in now.names if name not in last.names),
            removed=tuple(name for name in last.names if name not in now.names),
            gain=last.innovation - now.innovation,
            step=now,
        )
        for last, now in pairwise(steps)
    ]
