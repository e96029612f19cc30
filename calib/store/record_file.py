"""The record of a table as its JSON file has it."""

from dataclasses import MISSING, fields
from typing import Any, Literal, get_type_hints

from pydantic import ConfigDict, Field

from calib.base.record import FileSchema, Section, section
from calib.car.effects.effects import DefinedIn, Effects, EmpiricalTerm
from calib.car.vehicle import Vehicle
from calib.table.table import COLUMNS, CURVES, Array, Table, Value


def _keys(of: type) -> dict[str, tuple[Any, Any]]:
    """Type and default of each field of a dataclass."""
    kinds = get_type_hints(of)
    defaults = {one.name: one.default for one in fields(of)}
    return {
        name: (kinds[name], ... if default is MISSING else default)
        for name, default in defaults.items()
    }


_VEHICLE = section(
    "_VehicleRecord",
    "The vehicle in a record: of its effects only the named ones.",
    _keys(Vehicle)
    | {"mass_tolerance": (float, ...), "effects": (dict[str, dict[str, float]], ...)},
)


class _Finite(FileSchema):
    """A record without NaN."""

    model_config = ConfigDict(allow_inf_nan=False)


Record = section(
    "Record",
    "A table without its curves, as `Table`.",
    {name: key for name, key in _keys(Table).items() if name not in COLUMNS}
    | {
        "vehicle": (_VEHICLE, ...),
        "effects": (dict[str, dict[str, Value]], ...),
        "empirical": (EmpiricalTerm | tuple[EmpiricalTerm, ...], ()),
        "own_effects": (dict[str, DefinedIn], Field(default_factory=dict)),
    },
    _Finite,
)


class _Parent(Section):
    """A log that a table was made of."""

    name: str
    digest: str


class RecordFile(Section):
    """A stored table: its address, the SHA-256 of the file of each curve, and its record."""

    id: str
    version: int
    digest: str
    parents: tuple[_Parent, ...]
    files: dict[str, str]
    record: Record  # type: ignore[valid-type]
    states: Literal["journal.jsonl"]


def table_of(record: Any, curves: dict[str, dict[str, Array]]) -> Table:
    """Build the table from its `Record`, its curves and maps.

    Raises KeyError or TypeError for a curve or a column that is missing.
    """
    held = [name for name in COLUMNS if name in CURVES or name in curves]
    parts = {**dict(record), **{name: COLUMNS[name](**curves[name]) for name in held}}
    terms, own, found = parts.pop("empirical"), parts.pop("own_effects"), parts["effects"]
    named = record.vehicle.effects, terms if isinstance(terms, tuple) else (terms,)
    del parts["schema_version"]
    parts["vehicle"] = Vehicle(**{**dict(record.vehicle), "effects": Effects(*named, own=own)})
    values, sigma = (
        {effect: {p: getattr(v, part) for p, v in of.items()} for effect, of in found.items()}
        for part in ("value", "sigma")
    )
    parts["effects"] = Effects(values, sigma=sigma)
    return Table(**parts)
