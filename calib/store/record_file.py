"""Schemas of two JSON files, the record of a table and the summary of a validation.

`table_of` makes a table of its record again.
"""

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
    """Type and default of each field of a dataclass; the default of a required field is ``...``."""
    types = get_type_hints(record)
    defaults = {field.name: field.default for field in fields(record)}
    return {
        name: (types[name], ... if default is MISSING else default)
        for name, default in defaults.items()
    }


_VEHICLE = section(
    "_VehicleRecord",
    "The vehicle in a record, with the parameters of its effects from the catalogue.",
    _keys(Vehicle)
    | {"mass_tolerance": (float, ...), "effects": (dict[str, dict[str, float]], ...)},
)


class _FiniteNumbers(FileSchema):
    model_config = ConfigDict(allow_inf_nan=False)


Record = section(
    "Record",
    "The fields of a `Table` but for its curves and maps.",
    {name: key for name, key in _keys(Table).items() if name not in COLUMNS}
    | {
        "vehicle": (_VEHICLE, ...),
        "effects": (dict[str, dict[str, Value]], ...),
        "empirical": (EmpiricalTerm | tuple[EmpiricalTerm, ...], ()),
        "own_effects": (dict[str, DefinedIn], Field(default_factory=dict)),
    },
    _FiniteNumbers,
)


class _Parent(Section):
    """A log that a table was made of."""

    name: str
    digest: str
    sample_time: float | None = None


class RecordFile(Section):
    """The `record.json` of a version: its address, the SHA-256 of each curve's file, the record."""

    id: str
    version: int
    digest: str
    parents: tuple[_Parent, ...]
    files: dict[str, str]
    record: Record  # type: ignore[valid-type]
    states: Literal["journal.jsonl"]


class _ValidatedLog(Section):
    """A log that was validated. ``role`` tells whether the fit used it or it is a hold-out."""

    model_config = ConfigDict(extra="ignore")

    role: str


class SummaryFile(FileSchema):
    """The `summary.json` of a validation of one version of a table."""

    model_config = ConfigDict(extra="ignore")

    table: str
    digest: str
    verdict: Literal["passed", "failed"]
    proof: Literal["truth", "reference", "none"]
    logs: list[_ValidatedLog]


def table_of(
    record: Any, curves: dict[str, dict[str, Array]], sample_times: Sequence[float | None]
) -> Table:
    """Build the table from its `Record`, its curves and maps, and the sample time of its logs [s].

    Raises KeyError or TypeError for a curve or a column that is missing.
    """
    parts = dict(record)
    del parts["schema_version"]
    for name, constructor in COLUMNS.items():
        parts[name] = constructor(**curves[name])

    terms, own_effects = parts.pop("empirical"), parts.pop("own_effects")
    terms = terms if isinstance(terms, tuple) else (terms,)
    vehicle_effects = Effects(record.vehicle.effects, terms, user_defined=own_effects)
    parts["vehicle"] = Vehicle(**{**dict(record.vehicle), "effects": vehicle_effects})

    values: dict[str, dict[str, float]] = {}
    sigmas: dict[str, dict[str, float]] = {}
    for effect, parameters in parts["effects"].items():
        values[effect] = {name: fitted.value for name, fitted in parameters.items()}
        sigmas[effect] = {name: fitted.sigma for name, fitted in parameters.items()}
    parts["effects"] = Effects(values, sigma=sigmas)

    logs = zip(record.provenance.logs, sample_times, strict=True)
    timed = tuple(replace(log, sample_time=time) for log, time in logs)
    parts["provenance"] = replace(record.provenance, logs=timed)
    return Table(**parts)
