"""The look-up table as a value: curves and maps, with their origin and their uncertainty.

`Table.content` returns it as a JSON-able record and named float columns. The digest is over that
content, so no file format changes it.

    record  {schema, name, vehicle, calibration, budget, effects, noise, quality, provenance ...}
    curves  {"difference": {eta, D, ...}, "paper": {eta, z, f1, f2, ...},
             "tyre": {slip, force, ...}, "map": ..., "level_map": ..., "draws": ...}
"""

import json
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from calib.base.arrays import Array
from calib.base.digest import content_digest
from calib.base.extras import need
from calib.base.intervals import Z95
from calib.base.viewable import Viewable
from calib.base.warning import PlausibilityWarning
from calib.car.effects.combined import not_sensed
from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.run.same_run import Fingerprint, same_as
from calib.table.curves import DifferenceCurve, PaperCurves, TyreCurve
from calib.table.maps import MAPS, Draws, LevelMap, PadMap, columns

if TYPE_CHECKING:
    import pandas as pd

_OPTIONAL = {
    *("own_effects", "empirical", "notes", "fingerprint", "warnings", "spread"),
    *("identity", "parents", "pad_friction_tolerance"),
}
"""Keys that a record lacks where their value is empty."""
_CURVES = {"difference": DifferenceCurve, "paper": PaperCurves, "tyre": TyreCurve}
COLUMNS: dict[str, Any] = {**_CURVES, **MAPS, "draws": Draws.from_columns}
"""Constructors of the parts of a table that are columns, by name."""


@dataclass(frozen=True)
class Value:
    """A value with one standard deviation, in SI."""

    value: float
    sigma: float

    @property
    def ci95(self) -> tuple[float, float]:
        """95 % interval of a normal distribution."""
        return self.value - Z95 * self.sigma, self.value + Z95 * self.sigma

    def __str__(self) -> str:
        return f"{self.value:.4g} +- {self.ci95[1] - self.value:.2g}"


@dataclass(frozen=True)
class Calibration:
    """Pads and tyres from the ramps [1]: ``pad_scale`` common factor on the vehicle file's pads.

    ``pad_log_ratio`` ln of (mu_f/mu_r) over its nominal value; ``slip_stiffness`` normalised force
    per slip at small slip and half the weight, the geometric mean of the axles.
    """

    pad_scale: Value
    pad_log_ratio: Value
    pad_friction_f: Value
    pad_friction_r: Value
    slip_stiffness: Value


@dataclass(frozen=True)
class LogReference:
    """A log of the fit; ``digest`` SHA-256 of its bytes; ``notes`` of its reader.

    ``fingerprint`` tells a copy of the run from another run. ``sample_time`` [s] is not part of the
    content of a table: those that were stored without it keep their digests.
    """

    name: str
    digest: str
    role: str
    notes: tuple[str, ...] = ()
    fingerprint: Fingerprint | None = None
    sample_time: float | None = None

    def is_run_of(self, log: Log) -> bool:
        """Whether ``log`` is this run, even if it was cut, thinned, rounded or resampled."""
        return log.digest == self.digest or (
            self.fingerprint is not None and same_as(self.fingerprint, log)
        )


@dataclass(frozen=True)
class TableReference:
    """A version that a table was made of: its name@version and the SHA-256 of its content."""

    id: str
    digest: str


@dataclass(frozen=True)
class Provenance:
    """Where a table comes from.

    ``identity`` of the car; ``parents`` tables that it was merged from, or the cars of its prior,
    see `Table.fleet`.
    """

    logs: tuple[LogReference, ...]
    settings: dict[str, float]
    program: str
    identity: dict[str, str] = field(default_factory=dict)
    parents: tuple[TableReference, ...] = ()

    @property
    def sample_time(self) -> float | None:
        """Sample time of the logs [s], to four digits; None if they differ or it is not known."""
        times = {float(f"{log.sample_time:.4g}") for log in self.logs if log.sample_time}
        return times.pop() if len(times) == 1 else None

    def parent_of(self, log: Log) -> LogReference | None:
        """The log of the fit of which ``log`` is the run or a copy; None for another run."""
        return next((parent for parent in self.logs if parent.is_run_of(log)), None)


@dataclass(frozen=True)
class TableBudget:
    """Uncertainty of pads and tyres by part, see `calib.table.budget`.

    ``front``, ``rear`` standard deviation of the logarithm of each pad friction [1]; ``level``,
    ``ratio``, ``stiffness`` variances of those of pad level, pads' ratio and slip stiffness.
    """

    front: dict[str, float]
    rear: dict[str, float]
    level: dict[str, float]
    ratio: dict[str, float]
    stiffness: dict[str, float]

    @property
    def axles(self) -> tuple[dict[str, float], dict[str, float]]:
        """The parts of front and rear pads."""
        return self.front, self.rear


@dataclass(frozen=True)
class Scatter:
    """``between`` standard deviation between cars; ``of_mean`` standard error of their mean.

    ``of_mean`` counts what differs between cars and between runs, not errors common to all of them.
    """

    between: float
    of_mean: float


@dataclass(frozen=True)
class FleetScatter:
    """Scatter of ``cars`` cars: of D [1] at the rows of the table's D, and of logarithms [1].

    ``pad_level`` of the brake force of both axles per pressure; ``pad_ratio`` front over rear;
    ``stiffness`` slip stiffness of the tyres.
    """

    cars: int
    D: tuple[Scatter, ...]
    pad_level: Scatter
    pad_ratio: Scatter
    stiffness: Scatter

    @property
    def freedom(self) -> int:
        """Degrees of freedom of Student's t."""
        return self.cars - 1


@dataclass(frozen=True, eq=False)
class Table(Viewable):
    """A fitted table, without version: the store gives it one.

    ``effects`` holds drag and rolling resistance with their sigma; other known effects are in the
    vehicle; ``noise`` long-run noise density of each sensor [unit * s^0.5]; ``quality`` metrics of
    the fit; ``budget`` uncertainty of the pads by part; ``spread`` between the cars of a mean.
    ``map`` has the pads' ratio given eta and slip, ``level_map`` level and ratio without them;
    ``draws`` are some of the posterior, from which both are made.
    """

    name: str
    vehicle: Vehicle
    difference: DifferenceCurve
    paper: PaperCurves
    tyre: TyreCurve
    map: PadMap
    level_map: LevelMap
    draws: Draws
    calibration: Calibration
    budget: TableBudget
    effects: Effects
    noise: dict[str, float]
    quality: dict[str, float]
    remarks: tuple[str, ...]
    provenance: Provenance
    warnings: tuple[PlausibilityWarning, ...] = ()
    spread: FleetScatter | None = None

    def __repr__(self) -> str:
        eta, (low, high), pads = self.paper.eta, self.paper.decelerations, self.calibration
        logs = ", ".join(f"{log.name} ({log.role})" for log in self.provenance.logs)
        return (
            f"Table {self.name}, {self.provenance.program}\n"
            f"  f1, f2  {eta.size} rows, eta - 1 up to {100.0 * (eta[-1] - 1.0):.3f} %, "
            f"z {low:.2f} to {high:.2f} g\n"
            f"  pads    front {pads.pad_friction_f}, rear {pads.pad_friction_r} (95 %)\n"
            f"  logs    {logs}"
        )

    def f1(self, eta: ArrayLike) -> Array:
        """f1 of (11) [1] at ``eta`` [1], linear between rows; NaN beyond the measured rows."""
        return self.paper.read("f1", eta)

    def f2(self, eta: ArrayLike) -> Array:
        """f2 of (12) [1], as `f1`."""
        return self.paper.read("f2", eta)

    def curves(self) -> "pd.DataFrame":
        """Return D, f1 and f2 with their 95 % bands over eta; ``attrs["units"]`` has the units.

        Raises BrakeCalError without the extra `frames`.
        """
        d = self.difference
        difference = {"D": d.D, "D_lower": d.lower, "D_upper": d.upper}
        rows = need("pandas", "frames").DataFrame(difference | vars(self.paper))
        frame: pd.DataFrame = rows.set_index("eta")
        frame.attrs["units"] = dict.fromkeys(("eta", *frame.columns), "1")
        return frame

    def content(self) -> tuple[dict[str, Any], dict[str, dict[str, Array]]]:
        """Return the record (JSON-able) and the curves and maps (named float columns)."""
        curves = {name: columns(getattr(self, name)) for name in COLUMNS}
        record = asdict(self)
        effects = record["vehicle"].pop("effects")
        record["vehicle"]["effects"] = effects["parameters"]
        if self.vehicle.motor_odds == Vehicle.motor_odds:
            del record["vehicle"]["motor_odds"]
        definitions = self.vehicle.effects.defined_in.items()
        record["own_effects"] = {name: asdict(effect) for name, effect in definitions}
        terms = effects["terms"]
        record["empirical"] = terms[0] if len(terms) == 1 else terms
        record["effects"] = {
            effect: {name: asdict(value) for name, value in values.items()}
            for effect, values in self.effect_values.items()
        }
        for name in COLUMNS:
            del record[name]
        for log in record["provenance"]["logs"]:
            del log["sample_time"]
        return {"schema": 1, **json.loads(json.dumps(_written(record)))}, curves

    @property
    def not_sensed(self) -> dict[str, str]:
        """Effects that an ECU cannot take out, with the signal that it lacks; see `not_sensed`."""
        pressures = {"wheel_pressures": "the pressures of the wheels, which are not p_mc"}
        needed = any(warning.code in pressures for warning in self.warnings)
        return not_sensed(self.vehicle.effects) | (pressures if needed else {})

    @property
    def fleet(self) -> tuple[TableReference, ...]:
        """The cars of its model on which the prior of the fit rests."""
        return self.provenance.parents if self.spread is None else ()

    @property
    def effect_values(self) -> dict[str, dict[str, Value]]:
        """The parameters of the effects with sigma [SI], by effect and parameter name."""
        sigma = self.effects.sigma
        return {
            effect: {name: Value(value, sigma[effect][name]) for name, value in named.items()}
            for effect, named in self.effects.parameters.items()
        }

    @property
    def digest(self) -> str:
        """SHA-256 of the canonical content [hex]."""
        return content_digest(*self.content())


def _written(value: Any) -> Any:
    """A value without those of the `_OPTIONAL` keys that are empty."""
    if isinstance(value, dict):
        return {k: _written(v) for k, v in value.items() if v or k not in _OPTIONAL}
    return [_written(v) for v in value] if isinstance(value, list | tuple) else value
