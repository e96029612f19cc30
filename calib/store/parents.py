"""Versions that may be merged: several cars of one model, each measured, each once."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import combinations

from calib.base.errors import RevisionError
from calib.car.vehicle import NOT_OF_THE_CAR, Vehicle
from calib.store.version import Stored
from calib.table.table import Table

CAR_MARKS = ("serial", "vin")
"""Identifiers by which one car is known."""

LEAST_RANGE = 0.5
"""Share of the longest range of eta that every table must cover: the mean ends with the shortest,
and a golden table of half of the range judges half of the brake."""


def require_mergeable(parents: Sequence[Stored], name: str) -> None:
    """Raise RevisionError with all reasons why ``parents`` have no mean of the name ``name``."""
    if flaws := [*_number(parents), *_name(parents, name), *_each(parents), *_pairs(parents)]:
        raise RevisionError("; ".join(flaws))


def _number(parents: Sequence[Stored]) -> Iterator[str]:
    if len(parents) < 2:
        yield f"a mean needs two cars or more, {len(parents)} was given"


def _name(parents: Sequence[Stored], name: str) -> Iterator[str]:
    if name in {p.name for p in parents}:
        yield (
            f"the mean cannot be named {name!r}: it would be the next version of a car's table; "
            "take another name, such as golden"
        )


def _each(parents: Sequence[Stored]) -> Iterator[str]:
    ranges = [float(p.table.difference.eta[-1]) - 1.0 for p in parents]
    for parent, reach in zip(parents, ranges, strict=True):
        if not (parent.state.usable and parent.state.known):
            yield f"{parent.id} is {parent.state.words}; leave it out"
        if parent.table.spread is not None:
            yield f"{parent.id} is a mean of cars itself; merge the cars it was made of"
        if parent.table.by_hand:
            yield f"{parent.id} was corrected by hand and is no measurement; merge its parent"
        if reach < LEAST_RANGE * max(ranges):
            yield (
                f"{parent.id} ends at eta {1.0 + reach:.5f}, less than half of the range of the "
                f"longest, {1.0 + max(ranges):.5f}; leave it out"
            )


def _pairs(parents: Sequence[Stored]) -> Iterator[str]:
    for a, b in combinations(parents, 2):
        if a.digest == b.digest:
            yield f"{a.id} was given twice" if a.id == b.id else f"{a.id} and {b.id} are the same"
            continue
        if same := [m for m in CAR_MARKS if _identity(a, m) and _identity(a, m) == _identity(b, m)]:
            yield (
                f"{a.id} and {b.id} are of one car ({same[0]} {_identity(a, same[0])}), which "
                "would count as two; give one of them, or fit its ramps together"
            )
        if logs := sorted(_ramps(a.table) & _ramps(b.table)):
            yield f"{a.id} and {b.id} are made of the same ramp {logs[0][0]}"
        if differ := list(_differ(a.table.vehicle, b.table.vehicle)):
            yield f"{a.id} and {b.id} are of different vehicles: {', '.join(differ[:4])}"
        elif a.table.posterior.names != b.table.posterior.names:
            yield f"{a.id} and {b.id} have other tyre parameters; fit the older one again"


def _identity(stored: Stored, mark: str) -> str:
    return stored.table.provenance.identity.get(mark, "")


def _ramps(table: Table) -> set[tuple[str, str]]:
    """Name and digest of the ramps; a coast log may serve several tables."""
    return {(log.name, log.digest) for log in table.provenance.logs if log.role == "ramp"}


def _differ(a: Vehicle, b: Vehicle) -> Iterator[str]:
    """What differs but the name and what is open about the car."""
    first, second = (_flat(asdict(vehicle)) for vehicle in (a, b))
    for key in sorted({*first, *second} - {"name", *NOT_OF_THE_CAR}):
        if first.get(key) != second.get(key):
            yield f"{key} {_shown(first.get(key))} and {_shown(second.get(key))}"


def _flat(values: dict[str, object], path: str = "") -> dict[str, object]:
    out: dict[str, object] = {}
    for key, value in values.items():
        if isinstance(value, dict):
            out |= _flat(value, f"{path}{key}.")
        else:
            out[path + key] = value
    return out


def _shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
