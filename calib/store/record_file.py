"""JSON files of a store: the record of a table, and the summary of a validation as evidence."""

from dataclasses import fields
from typing import Any, Literal

from pydantic import ConfigDict, Field

from calib.base.record import FileSchema, Section
from calib.base.warning import PlausibilityWarning
from calib.car.effects.effects import DefinedIn, Effects, EmpiricalTerm
from calib.car.vehicle import Axle, Vehicle
from calib.table.table import (
    Array,
    Calibration,
    DifferenceCurve,
    FleetScatter,
    PaperCurves,
    Provenance,
    SetByHand,
    Table,
    TableBudget,
    TyreCurve,
    TyrePosterior,
    Value,
)


class _VehicleRecord(Section):
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
    vehicle: _VehicleRecord
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
    record: Record
    states: Literal["journal.jsonl"] | None = None


class _LogOutcome(Section):
    """A log that was validated."""

    model_config = ConfigDict(extra="ignore")

    log: str
    role: str
    verdict: str


class SummaryFile(FileSchema):
    """The `summary.json` of a validation of one version of a table."""

    model_config = ConfigDict(extra="ignore")

    table: str
    digest: str | None = None
    verdict: Literal["passed", "failed"]
    logs: list[_LogOutcome]


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
    parts["effects"] = Effects(
        {effect: {p: v.value for p, v in of.items()} for effect, of in record.effects.items()},
        sigma={
            effect: {p: v.sigma for p, v in of.items()} for effect, of in record.effects.items()
        },
    )
    return Table(
        **parts,
        difference=DifferenceCurve(**curves["difference"]),
        paper=PaperCurves(**curves["paper"]),
        tyre=TyreCurve(**curves["tyre"]),
    )
