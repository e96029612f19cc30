"""The record of a stored table as a JSON file, and the table built from it."""

from dataclasses import fields
from typing import Any, Literal

from pydantic import ConfigDict, Field

from calib.base.digest import canonical_json
from calib.base.errors import StoreError
from calib.base.record import FileSchema, Section, validated
from calib.base.warning import PlausibilityWarning
from calib.car.effects.effects import DefinedIn, Effects, EmpiricalTerm
from calib.car.vehicle import Axle, Vehicle
from calib.store.curve_file import Array
from calib.table.budget import TableBudget
from calib.table.by_hand import SetByHand
from calib.table.spread import FleetScatter
from calib.table.table import (
    Calibration,
    DifferenceCurve,
    PaperCurves,
    Provenance,
    Table,
    TyreCurve,
    TyrePosterior,
    Value,
)


class VehicleRecord(Section):
    """The vehicle in a record: of its effects only the named ones."""

    name: str
    mass: float
    cg_to_front_axle: float
    cg_to_rear_axle: float
    cg_height: float
    track_width: float
    front: Axle
    rear: Axle
    mass_tolerance: float
    motor_odds: float = Vehicle.motor_odds
    effects: dict[str, dict[str, float]]


class Record(FileSchema):
    """A table without its curves, as `Table`."""

    model_config = ConfigDict(allow_inf_nan=False)

    name: str
    vehicle: VehicleRecord
    posterior: TyrePosterior
    calibration: Calibration
    effects: dict[str, dict[str, Value]]
    noise: dict[str, float]
    quality: dict[str, float]
    remarks: tuple[str, ...]
    provenance: Provenance
    empirical: EmpiricalTerm | tuple[EmpiricalTerm, ...] = ()
    own_effects: dict[str, DefinedIn] = Field(default_factory=dict)
    warnings: tuple[PlausibilityWarning, ...] = ()
    budget: TableBudget | None = None
    spread: FleetScatter | None = None
    by_hand: tuple[SetByHand, ...] = ()


class Parent(Section):
    """A log that a table was made of."""

    name: str
    digest: str


class RecordFile(Section):
    """A stored table: its address, the SHA-256 of the file of each curve, and its record."""

    id: str
    version: int
    digest: str
    parents: tuple[Parent, ...]
    files: dict[str, str]
    record: Record
    states: Literal["journal.jsonl"] | None = None


def from_content(record: dict[str, Any], curves: dict[str, dict[str, Array]]) -> Table:
    """Build the table that `Table.content` described.

    Raises StoreError for another version of the schema and for a part of the record that is
    missing, unknown or of another type; KeyError or TypeError for one of the curves.
    """
    checked = validated(canonical_json(record), Record, "record of a table", StoreError)
    return table_of(checked, curves)


def table_of(record: Record, curves: dict[str, dict[str, Array]]) -> Table:
    """Build the table from its record and its curves.

    Raises KeyError or TypeError for a curve or a column that is missing.
    """
    parts: dict[str, Any] = {
        field.name: getattr(record, field.name)
        for field in fields(Table)
        if field.name in Record.model_fields
    }
    terms = record.empirical if isinstance(record.empirical, tuple) else (record.empirical,)
    effects = Effects(record.vehicle.effects, terms, own=record.own_effects)
    parts["vehicle"] = Vehicle(**{**dict(record.vehicle), "effects": effects})
    parts["effects"] = _with_sigma(record.effects)
    return Table(
        **parts,
        difference=DifferenceCurve(**curves["difference"]),
        paper=PaperCurves(**curves["paper"]),
        tyre=TyreCurve(**curves["tyre"]),
    )


def _with_sigma(values: dict[str, dict[str, Value]]) -> Effects:
    return Effects(
        {effect: {p: v.value for p, v in named.items()} for effect, named in values.items()},
        sigma={effect: {p: v.sigma for p, v in named.items()} for effect, named in values.items()},
    )
