"""How the numbers of a file were rounded by who wrote it, from the numbers themselves.

A tool that saves a file writes all of its numbers in one way: with all their bits, in single
precision, with so many significant digits, or with so many decimals. The way that fewest numbers
contradict is taken, the finest of several. A number that contradicts it was changed.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

FEW = 0.1
"""Share of the numbers that may have more digits than the tool writes: those that were changed.
Of numbers written to a digit one in ten ends with a zero, which is not counted, so most have it."""

COARSEST = 3
"""Significant digits below which a number is not called rounded."""

SLACK = 1.0 + 1e-6
"""Of half a unit of the last digit: the sums here round, too."""


@dataclass(frozen=True)
class Pair:
    """A number as found in a file, with what the table has there; ``where`` its label and place."""

    where: str
    found: float
    true: float


def best_rounding(pairs: Sequence[Pair]) -> tuple[str, list[Pair]]:
    """The way in which the found numbers were rounded, and those that it does not explain.

    The way is empty where the numbers are those of the table to the last bit.

    >>> best_rounding([Pair("a", 0.333333, 1 / 3), Pair("b", 666.667, 2000 / 3)])
    ('to 6 significant digits', [])
    >>> best_rounding([Pair("a", 0.25, 0.25), Pair("b", 0.4, 0.38)])
    ('', [Pair(where='b', found=0.4, true=0.38)])
    """
    ways = _ways([pair.found for pair in pairs])
    told = [(way, [pair for pair in pairs if not holds(pair)]) for way, holds in ways]
    return min(told, key=lambda one: len(one[1]))


def _ways(found: Sequence[float]) -> Iterator[tuple[str, Callable[[Pair], bool]]]:
    """Each way with its rule, the finest first."""
    yield "", lambda pair: pair.found.hex() == pair.true.hex()
    yield "to single precision", _is_single
    written = [Decimal(repr(x)).normalize() for x in found if x]
    digits = _usual([len(x.as_tuple().digits) for x in written])
    decimals = _usual([-int(x.as_tuple().exponent) for x in written])
    if digits >= COARSEST:
        yield (
            f"to {digits} significant digits",
            lambda pair: _within(pair, _half_unit(pair.true, digits)),
        )
        yield f"to {decimals} decimals", lambda pair: _within(pair, 0.5 * 10.0**-decimals)


def _usual(counts: Sequence[int]) -> int:
    """What a tenth of the numbers reaches or passes; 0 without numbers."""
    return sorted(counts)[-1 - int(FEW * (len(counts) - 1))] if counts else 0


def _is_single(pair: Pair) -> bool:
    """Whether a number is that of the table in single precision, as short as it may be written."""
    single = float(np.float32(pair.true))
    own = len(Decimal(repr(pair.found)).normalize().as_tuple().digits)
    same = np.float32(pair.found) == np.float32(pair.true)
    return bool(same) and abs(pair.found - single) <= _half_unit(single, own) * SLACK


def _within(pair: Pair, half: float) -> bool:
    """Whether a number lies within ``half`` of the table's, or of that in single precision."""
    near = min(abs(pair.found - x) for x in (pair.true, float(np.float32(pair.true))))
    return near <= half * SLACK


def _half_unit(x: float, digits: int) -> float:
    """Half a unit of the last of so many significant digits of ``x``."""
    return 0.5 * 10.0 ** (math.floor(math.log10(abs(x))) + 1 - digits) if x else 0.0
