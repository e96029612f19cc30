"""Schemas of JSON files: the record of a table, and the summary of a validation."""

from collections.abc import Sequence
from dataclasses import MISSING, fields, replace
from typing import Any, Literal, get_type_hints

from pydantic import ConfigDict, Field

from calib.base.arrays import Array
from calib.base.record import FileSchema, Section, section
from calib.car.effects.effects import DefinedIn, Effects, EmpiricalTerm
from calib.car.vehicle import Vehicle
from calib.table.table import COLUMNS, Table, Value


def _keys(record: type) -> dict[str, tuple[Any, Any]]:
    """Type and default of each field of a dataclass."""
    kinds = get_type_hints(record)
    return {
        field.name: (kinds[field.name], ... if field.default is MISSING else field.default)
        for field in fields(record)
    }


_VEHICLE = section(
    "_VehicleRecord",
    "The vehicle in a record: of its effects only the named ones.",
    _keys(Vehicle)
    | {"mass_tolerance": (float, ...), "effects": (dict[str, dict[str, float]], ...)},
)


class _Finite(FileSchema):
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
    sample_time: float | None = None


class RecordFile(Section):
    """A stored table: its address, the SHA-256 of each curve's file, and its record."""

    id: str
    version: int
    digest: str
    parents: tuple[_Parent, ...]
    files: dict[str, str]
    record: Record  # type: ignore[valid-type]
    states: Literal["journal.jsonl"]


class _LogOutcome(Section):
    """A log that was validated."""

    model_config = ConfigDict(extra="ignore")

    role: str


class SummaryFile(FileSchema):
    """The `summary.json` of a validation of one version of a table."""

    model_config = ConfigDict(extra="ignore")

    table: str
    digest: str
    verdict: Literal["passed", "failed"]
    proof: Literal["truth", "reference", "none"]
    logs: list[_LogOutcome]


def table_of(
    record: Any, curves: dict[str, dict[str, Array]], sample_times: Sequence[float | None]
) -> Table:
    """Build the table from its `Record`, its curves and maps; ``sample_times`` of its logs [s].

    Raises KeyError or TypeError for a curve or a column that is missing.
    """
    parts = {**dict(record), **{name: of(**curves[name]) for name, of in COLUMNS.items()}}
    terms, own_effects, effects = parts.pop("empirical"), parts.pop("own_effects"), parts["effects"]
    named = record.vehicle.effects, terms if isinstance(terms, tuple) else (terms,)
    del parts["schema_version"]
    vehicle_effects = Effects(*named, user_defined=own_effects)
    parts["vehicle"] = Vehicle(**{**dict(record.vehicle), "effects": vehicle_effects})
    values, sigma = (
        {effect: {p: getattr(v, part) for p, v in x.items()} for effect, x in effects.items()}
        for part in ("value", "sigma")
    )
    parts["effects"] = Effects(values, sigma=sigma)
    logs = zip(record.provenance.logs, sample_times, strict=True)
    timed = tuple(replace(log, sample_time=time) for log, time in logs)
    parts["provenance"] = replace(record.provenance, logs=timed)
    return Table(**parts)
