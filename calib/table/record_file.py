"""The record of a stored table as a JSON file, read back as the value that it was."""

from dataclasses import fields
from typing import Any

from pydantic import ConfigDict

from calib.digest import canonical_json
from calib.errors import StoreError
from calib.physics.effects.empirical import Empirical
from calib.physics.vehicle import Vehicle
from calib.schema import FileSchema, Section, validated_json
from calib.table.curve_file import Array
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


class Record(FileSchema):
    """A table without its curves, as `Table`."""

    model_config = ConfigDict(allow_inf_nan=False)

    name: str
    vehicle: Vehicle
    posterior: TyrePosterior
    calibration: Calibration
    effects: dict[str, dict[str, Value]]
    noise: dict[str, float]
    quality: dict[str, float]
    remarks: tuple[str, ...]
    provenance: Provenance
    empirical: Empirical | None = None


class Parent(Section):
    """A log that a table was made of."""

    name: str
    digest: str


class Address(Section):
    """What a listing reads of a stored table."""

    model_config = ConfigDict(extra="ignore")

    digest: str
    parents: tuple[Parent, ...]


class RecordFile(Address):
    """A stored table: its address, the SHA-256 of the file of each curve, and its record."""

    model_config = ConfigDict(extra="forbid")

    id: str
    version: int
    files: dict[str, str]
    record: Record


def from_content(record: dict[str, Any], curves: dict[str, dict[str, Array]]) -> Table:
    """Build the table that `Table.content` described.

    Raises StoreError for another version of the schema and for a part of the record that is
    missing, unknown or of another type; KeyError or TypeError for one of the curves.
    """
    checked = validated_json(canonical_json(record), Record, "record of a table", StoreError)
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
    return Table(
        **parts,
        difference=DifferenceCurve(**curves["difference"]),
        paper=PaperCurves(**curves["paper"]),
        tyre=TyreCurve(**curves["tyre"]),
    )
