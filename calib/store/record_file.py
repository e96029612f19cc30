"""JSON files of a store: the record of a table, a summary as evidence, what a user has seen."""

from dataclasses import MISSING, fields
from typing import Annotated, Any, Literal, get_type_hints

from pydantic import ConfigDict, Field

from calib.base.arrays import Array
from calib.base.record import FileSchema, Section, section
from calib.car.effects.effects import DefinedIn, Effects, EmpiricalTerm
from calib.car.vehicle import Vehicle
from calib.table.table import COLUMNS, Table, Value


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
    digest: str
    verdict: Literal["passed", "failed"]
    proof: Literal["truth", "reference", "none"]
    logs: list[_LogOutcome]


_Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Sight(Section):
    """The newest line of a journal that was seen: its hash, ``head``, and its number, ``lines``.

    ``key`` id of the key that it was verified with; ``store`` hash of the first line; ``place``
    folder of the store.
    """

    key: str
    store: _Hash
    place: str
    head: _Hash
    lines: Annotated[int, Field(ge=1)]

    @property
    def of(self) -> tuple[str, str, str]:
        """What it is a sight of; of these only the newest is kept."""
        return self.key, self.store, self.place


class SeenFile(FileSchema):
    """What a user has seen of stores."""

    seen: tuple[Sight, ...]


def table_of(record: Any, curves: dict[str, dict[str, Array]]) -> Table:
    """Build the table from its `Record`, its curves and maps.

    Raises KeyError or TypeError for a curve or a column that is missing.
    """
    parts = {**dict(record), **{name: of(**curves[name]) for name, of in COLUMNS.items()}}
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
