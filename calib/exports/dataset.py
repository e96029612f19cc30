"""A table as calibration tools use it: axes, curves over them, scalars, and their origin.

Every format writes one `Dataset`; its `Content` is the same in all formats.
"""

import hashlib
from dataclasses import dataclass

from calib.exports.breakpoints import Misfit
from calib.store.quality import Quality
from calib.store.state import VersionState
from calib.table.by_hand import SetByHand
from calib.table.table import Array

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
