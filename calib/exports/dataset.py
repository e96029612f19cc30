"""A table as calibration tools use it: axes, curves over them, scalars, and their origin.

Every format writes one `Dataset`; its `Content` is the same in all formats. A file that is read
back is `Returned`: an export of this program when it names a table, in its head or by its labels,
since a tool that saves a file keeps labels and numbers, and seldom the head.
"""

import hashlib
import re
import unicodedata
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.base.errors import ExchangeError
from calib.exports.breakpoints import Misfit
from calib.store.evidence import Quality
from calib.store.state import VersionState
from calib.table.table import Array, SetByHand

LONGEST = 31
"""Significant characters of an external name in every C99 compiler."""

LONGEST_PREFIX = 16
MARK = 4
"""Digits of the digest behind a shortened name."""


def prefix(name: str) -> str:
    """Label of a table's name, at most 16 characters.

    >>> prefix("sedan-2up"), prefix("2up")
    ('sedan_2up', 't_2up')
    >>> prefix("Müller")
    'Muller_a784'
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    word = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")
    if not word[:1].isalpha():
        word = f"t_{word}".rstrip("_")
    whole = re.fullmatch(r"[A-Za-z0-9._-]+", name) is not None
    if whole and len(word) <= LONGEST_PREFIX:
        return word
    return _marked(word, name, LONGEST_PREFIX)


def label(first: str, *parts: str) -> str:
    """Label of one curve or scalar, at most 31 characters.

    >>> label("sedan_2up", "f1")
    'sedan_2up_f1'
    """
    whole = "_".join((first, *parts))
    return whole if len(whole) <= LONGEST else _marked(whole, whole, LONGEST)


def printable(text: str) -> str:
    """``text`` on one line, without control characters."""
    return "".join(c if c.isprintable() else " " for c in text)


def _marked(word: str, name: str, longest: int) -> str:
    mark = hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:MARK]
    return f"{word[: longest - MARK - 1].rstrip('_')}_{mark}"


CLAMP = (
    "outside an axis the value at its nearest end holds (clamped, never extrapolated); "
    "the estimator marks such samples as not valid"
)
"""Values of a look-up beyond the ends, as in `calib.estimation.lookup`."""

BY_A_PERSON = "set by hand"
"""How the meaning of an object ends that a person set."""


NOT = "NOT RELEASED, not for use in a vehicle: "
"""Before the state of a version that is not released, in every format."""


@dataclass(frozen=True)
class Axis:
    """Breakpoints, strictly increasing. ``values`` (n,) in ``unit``.

    ``shared`` by several curves, or the own axis of one; ``origin`` of the fixed point; ``rows``
    number of rows of the table; ``misfit`` of the curves interpolated between the breakpoints.
    """

    label: str
    meaning: str
    unit: str
    values: Array
    shared: bool
    origin: float
    rows: int
    misfit: Misfit


@dataclass(frozen=True)
class Curve:
    """A curve over the axis of that label, with 95 % band, counts and flags; shapes (n,)."""

    label: str
    axis: str
    meaning: str
    unit: str
    values: Array
    lower: Array
    upper: Array
    count: Array
    flag: Array


@dataclass(frozen=True)
class Scalar:
    """A number in ``unit`` (SI); ``sigma`` one standard deviation where it was fitted."""

    label: str
    meaning: str
    unit: str
    value: float
    sigma: float | None = None


@dataclass(frozen=True)
class Content:
    """The bare numbers: shared axes, curves as (x, y), scalars, each by label."""

    axes: dict[str, tuple[float, ...]]
    curves: dict[str, tuple[tuple[float, ...], tuple[float, ...]]]
    scalars: dict[str, float]

    @property
    def checksum(self) -> str:
        """SHA-256 over labels and numbers with all their bits [hex]."""
        lines = [f"scalar {n} {float(v).hex()}" for n, v in sorted(self.scalars.items())]
        lines += [f"axis {n} {_hex(v)}" for n, v in sorted(self.axes.items())]
        lines += [f"curve {n} {_hex(x)} of {_hex(y)}" for n, (x, y) in sorted(self.curves.items())]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


@dataclass(frozen=True)
class Dataset:
    """The exported data of one version of a table.

    ``id`` name@version; ``digest`` of the whole table; ``program`` that fitted it; ``quality``
    result of a validation; ``release`` the state of the version; ``parents`` ids of the tables that
    it was made of; ``by_hand`` what a person set in it.
    """

    id: str
    version: int
    digest: str
    program: str
    vehicle: str
    prefix: str
    axes: tuple[Axis, ...]
    curves: tuple[Curve, ...]
    scalars: tuple[Scalar, ...]
    quality: Quality
    release: VersionState
    parents: tuple[str, ...] = ()
    by_hand: tuple[SetByHand, ...] = ()

    def axis(self, label: str) -> Axis:
        """The axis of that label."""
        return next(a for a in self.axes if a.label == label)

    def over(self, axis: Axis) -> list[Curve]:
        """The curves over an axis."""
        return [c for c in self.curves if c.axis == axis.label]

    @property
    def blocks(self) -> int:
        """Objects in a file: shared axes, curves and scalars."""
        return sum(a.shared for a in self.axes) + len(self.curves) + len(self.scalars)

    @property
    def arrays(self) -> dict[str, Array]:
        """The numbers of every object by label, axes first; shapes (n,)."""
        return {
            **{axis.label: axis.values for axis in self.axes},
            **{curve.label: curve.values for curve in self.curves},
            **{scalar.label: np.array([scalar.value]) for scalar in self.scalars},
        }

    def content(self) -> Content:
        """The bare numbers."""
        return Content(
            {a.label: _floats(a.values) for a in self.axes if a.shared},
            {c.label: (_floats(self.axis(c.axis).values), _floats(c.values)) for c in self.curves},
            {s.label: s.value for s in self.scalars},
        )

    def facts(self) -> dict[str, str]:
        """Facts that every file states, by key."""
        return {
            "table": self.id,
            "version": str(self.version),
            "digest": self.digest,
            "program": self.program,
            "vehicle": self.vehicle,
            **({"parents": ", ".join(self.parents)} if self.parents else {}),
            **({BY_A_PERSON: "; ".join(map(str, self.by_hand))} if self.by_hand else {}),
            "ends": CLAMP,
            **{f"breakpoints {a.label}": placed(a) for a in self.axes},
            "validation": self.quality.words,
            "state": self.quality.state,
            "release": ("" if self.release.released else NOT) + self.release.why,
            "objects": str(self.blocks),
            "checksum": self.content().checksum,
        }


def placed(axis: Axis) -> str:
    """Number of breakpoints of an axis and their interpolation error, in words."""
    if len(axis.values) == axis.rows:
        return f"all {axis.rows} rows of the table; interpolation error 0"
    m = axis.misfit
    return (
        f"{len(axis.values)} of {axis.rows} rows; interpolation error at most {m.worst:.6g} "
        f"(at {m.at:.8g}), rms {m.rms:.6g}"
    )


def span(values: Array) -> str:
    """Range of some numbers, in words."""
    return f"range {float(values.min())!r} to {float(values.max())!r}"


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in values)


def _hex(values: tuple[float, ...]) -> str:
    return " ".join(v.hex() for v in values)


VERSION = "_version"
"""How the label of the scalar ends that holds the version of the table."""


@dataclass(frozen=True)
class Returned:
    """A file read back: ``format`` DCM or CDF, ``facts`` by key, and its numbers.

    ``prefix`` of the labels of the table, ``table`` its id: as the head has it, or by the labels.
    """

    format: str
    facts: dict[str, str]
    units: dict[str, str]
    content: Content
    prefix: str
    table: str

    @property
    def unchanged(self) -> bool | None:
        """Whether the numbers agree with the checksum; None where the file states none."""
        stated = self.facts.get("checksum")
        return None if stated is None else stated == self.content.checksum


def returned(
    path: Path, form: str, facts: dict[str, str], units: dict[str, str], content: Content
) -> Returned:
    """Make a `Returned`. Raises ExchangeError where no table is named or objects are missing."""
    firsts = [name.removesuffix(VERSION) for name in content.scalars if name.endswith(VERSION)]
    firsts = [first for first in firsts if f"{first}_D" in content.curves]
    if len(firsts) != 1:
        raise ExchangeError(
            f"{form} with the labels of {len(firsts)} tables, such as NAME{VERSION} and NAME_D",
            where=path,
            expected="an export of one table, or that file as another tool has saved it",
        )
    first = firsts[0]
    found = len(content.axes) + len(content.curves) + len(content.scalars)
    if facts.get("objects", str(found)) != str(found):
        raise ExchangeError(
            f"holds {found} objects and states {facts['objects']}: cut off, or joined",
            where=path,
            do="export the table again",
        )
    table = facts.get("table", f"{first}@{content.scalars[first + VERSION]:.0f}")
    return Returned(form, facts, units, content, first, table)
