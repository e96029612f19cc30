"""Schemas of two JSON files, the record of a table and the summary of a validation.

The end of this file turns a record into a table.
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
    """Return type and default of each field of a dataclass; ``...`` marks a required field."""
    types = get_type_hints(record)
    return {
        field.name: (types[field.name], ... if field.default is MISSING else field.default)
        for field in fields(record)
    }


_VEHICLE = section(
    "_VehicleRecord",
    "The vehicle in a record, with the parameters of its effects from the catalogue.",
    _keys(Vehicle)  # two keys differ: both are required, effects are plain numbers
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
        "empirical": (EmpiricalTerm | tuple[EmpiricalTerm, ...], ()),  # one term has no list
        "own_effects": (dict[str, DefinedIn], Field(default_factory=dict)),
    },
    _FiniteNumbers,
)


class _Parent(Section):
    name: str
    digest: str
    sample_time: float | None = None


class RecordFile(Section):
    """The `record.json` of a version, see `calib.store.version`."""

    id: str
    version: int
    digest: str
    parents: tuple[_Parent, ...]
    files: dict[str, str]  # SHA-256 of each curve's file
    record: Record  # type: ignore[valid-type]
    states: Literal["journal.jsonl"]


class _ValidatedLog(Section):
    model_config = ConfigDict(extra="ignore")

    role: str  # "hold-out" if the fit did not use the log


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
    """Build the table from its `Record`, and its curves and maps.

    ``sample_times`` of its logs [s] are no part of the content, and so not in the record.
    Raises KeyError or TypeError if a curve or a column is missing.
    """
    arguments = dict(record)
    for key in ("schema_version", "empirical", "own_effects"):  # no fields of a table
        del arguments[key]
    for name, constructor in COLUMNS.items():
        arguments[name] = constructor(**curves[name])

    terms = record.empirical if isinstance(record.empirical, tuple) else (record.empirical,)
    vehicle_effects = Effects(record.vehicle.effects, terms, user_defined=record.own_effects)
    arguments["vehicle"] = Vehicle(**dict(record.vehicle) | {"effects": vehicle_effects})

    values: dict[str, dict[str, float]] = {}
    sigmas: dict[str, dict[str, float]] = {}
    for effect, parameters in record.effects.items():
        values[effect] = {name: fitted.value for name, fitted in parameters.items()}
        sigmas[effect] = {name: fitted.sigma for name, fitted in parameters.items()}
    arguments["effects"] = Effects(values, sigma=sigmas)

    logs = zip(record.provenance.logs, sample_times, strict=True)
    timed = tuple(replace(log, sample_time=time) for log, time in logs)
    arguments["provenance"] = replace(record.provenance, logs=timed)
    return Table(**arguments)
