from dataclasses import dataclass
from pathlib import Path

import pytest

from calib.store.store import Store
from calib.store.version import Stored

ROOT = Path(__file__).parents[2]


@pytest.fixture(params=["sedan-2up", "sedan-sim", "escort"])
def real(request) -> Stored:
    """A table of the repository's own store."""
    return Store(ROOT / "tables").load(request.param)


@dataclass(frozen=True)
class Truth:
    """What must come back of a table, taken from the table itself: (x, y) by short name."""

    curves: dict[str, tuple[list[float], list[float]]]

    def at(self, points):
        """Curves on the rows of these breakpoints, by bits."""
        return {
            name: [(x.hex(), y.hex()) for x, y in zip(*curve, strict=True) if x in points]
            for name, curve in self.curves.items()
        }


@pytest.fixture
def truth():
    def of(stored: Stored) -> Truth:
        t = stored.table
        eta, slip = t.paper.eta.tolist(), t.tyre.slip.tolist()
        return Truth(
            {
                "f1": (eta, t.paper.f1.tolist()),
                "f2": (eta, t.paper.f2.tolist()),
                "D": (t.difference.eta.tolist(), t.difference.D.tolist()),
                "g": (slip, t.tyre.force.tolist()),
            }
        )

    return of


def bits(x, y):
    """Pairs of numbers, every bit of them."""
    return [(float(a).hex(), float(b).hex()) for a, b in zip(x, y, strict=True)]
