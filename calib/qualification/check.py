"""One check: a number of the program against a truth that is known beforehand.

A check computes its value from the material; the outcome holds the value and whether it is right.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib.util import find_spec

from calib.qualification.material import Material

COUNT = 0.5
"""Tolerance of a number that is counted: it must be exact."""


@dataclass(frozen=True)
class Check:
    """What is computed, and what must come out.

    ``quantity`` in words; ``expected`` and ``tolerance`` [``unit``], the tolerance above zero;
    ``truth`` where the expected value comes from; ``measure`` computes the value; ``needs`` modules
    that an extra of the package installs.
    """

    name: str
    quantity: str
    unit: str
    expected: float
    tolerance: float
    truth: str
    measure: Callable[[Material], float]
    needs: tuple[str, ...] = ()

    @property
    def missing(self) -> tuple[str, ...]:
        """Modules that the check needs and that are not installed: it cannot be made."""
        return tuple(name for name in self.needs if find_spec(name) is None)


@dataclass(frozen=True)
class Outcome:
    """A check and its ``value`` [unit of the check]; None where it ended with an ``error``."""

    check: Check
    value: float | None
    error: str = ""

    @property
    def deviation(self) -> float | None:
        """Value less the expected one, over the tolerance [1]; None without a finite value."""
        if self.value is None or not math.isfinite(self.value):
            return None
        return (self.value - self.check.expected) / self.check.tolerance

    @property
    def held(self) -> bool:
        """Whether the value is within the tolerance."""
        return self.deviation is not None and abs(self.deviation) <= 1.0

    @property
    def rounded(self) -> int | None:
        """The deviation in whole tolerances [1], equal where machines differ by rounding only."""
        return None if self.deviation is None else round(self.deviation)


def run(
    checks: Iterable[Check], material: Material, done: Callable[[], None] = lambda: None
) -> tuple[Outcome, ...]:
    """Make every check on ``material``; one that ends with an error has failed.

    ``done`` is called after each.
    """
    outcomes = []
    for check in checks:
        outcomes.append(_outcome(check, material))
        done()
    return tuple(outcomes)


def _outcome(check: Check, material: Material) -> Outcome:
    try:
        return Outcome(check, float(check.measure(material)))
    except Exception as error:  # whatever breaks is a finding here, and must not end the others
        return Outcome(check, None, f"{type(error).__name__}: {error}")
