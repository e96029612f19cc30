"""The look-up table as a value: curves and maps, with their origin and their uncertainty.

`Table.content` returns a table as two parts, a record of JSON types and named columns of numbers:

    record  {schema, name, vehicle, calibration, budget, effects, noise, quality, provenance ...}
    curves  {"difference": {eta, D, ...}, "paper": {eta, z, f1, f2, ...},
             "tyre": {slip, force, ...}, "map": ..., "level_map": ..., "draws": ...}

The digest of a table is over this content, so it does not depend on a file format.
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
    "own_effects", "empirical", "notes", "fingerprint", "warnings", "spread", "identity", "parents",
    "pad_friction_tolerance",
}  # fmt: skip
"""Keys that are left out of a record where their value is empty."""

_CURVES = {"difference": DifferenceCurve, "paper": PaperCurves, "tyre": TyreCurve}
COLUMNS: dict[str, Any] = {**_CURVES, **MAPS, "draws": Draws.from_columns}
"""The parts of a table that are columns, by name; the values construct a part from its columns."""


@dataclass(frozen=True)
class Value:
    """A value with its standard deviation ``sigma``, in SI."""

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
    """Pads and tyres as the ramps show them, all [1]."""

    pad_scale: Value  # common factor on the pads of the vehicle file
    pad_log_ratio: Value  # ln of (mu_f/mu_r) over its nominal value
    pad_friction_f: Value
    pad_friction_r: Value
    slip_stiffness: Value
    """Normalised force per slip at small slip and half the weight, geometric mean of the axles."""


@dataclass(frozen=True)
class LogReference:
    """A log of the fit."""

    name: str
    digest: str  # SHA-256 of its bytes
    role: str  # its use in the fit, such as "ramp"
    notes: tuple[str, ...] = ()  # what its reader noted
    fingerprint: Fingerprint | None = None  # tells a copy of the run from another run
    sample_time: float | None = None  # [s]; no part of the content, so older digests stay

    def is_run_of(self, log: Log) -> bool:
        """Whether ``log`` is this run, even if it was cut, thinned, rounded or resampled."""
        if log.digest == self.digest:
            return True
        return self.fingerprint is not None and same_as(self.fingerprint, log)


@dataclass(frozen=True)
class TableReference:
    """A table that another table was made of: its name@version and the SHA-256 of its content."""

    id: str
    digest: str


@dataclass(frozen=True)
class Provenance:
    """Where a table comes from: its logs, the settings of the fit and the program."""

    logs: tuple[LogReference, ...]
    settings: dict[str, float]
    program: str
    identity: dict[str, str] = field(default_factory=dict)  # of the car, such as its VIN
    parents: tuple[TableReference, ...] = ()
    """The tables that were merged into this table, or the cars of its prior, see `Table.fleet`."""

    @property
    def sample_time(self) -> float | None:
        """Sample time of the logs [s], to four digits; None if it differs or is not known."""
        times = {float(f"{log.sample_time:.4g}") for log in self.logs if log.sample_time}
        return times.pop() if len(times) == 1 else None

    def fitted_log_of(self, log: Log) -> LogReference | None:
        """Return the log of the fit that holds the same run as ``log``, or None."""
        return next((fitted for fitted in self.logs if fitted.is_run_of(log)), None)


@dataclass(frozen=True)
class TableBudget:
    """Uncertainty of ln of pads and tyres [1], by part as in `calib.table.budget`."""

    front: dict[str, float]  # standard deviations of the front pad friction
    rear: dict[str, float]  # standard deviations of the rear pad friction
    level: dict[str, float]  # variances of the pads' level
    ratio: dict[str, float]  # variances of the pads' ratio
    stiffness: dict[str, float]  # variances of the slip stiffness

    @property
    def axles(self) -> tuple[dict[str, float], dict[str, float]]:
        """The parts of front and rear pads."""
        return self.front, self.rear


@dataclass(frozen=True)
class Scatter:
    """How a value differs between cars."""

    between: float  # standard deviation
    of_mean: float  # standard error of the mean, without errors that are common to all cars


@dataclass(frozen=True)
class FleetScatter:
    """Scatter between ``cars`` cars: of D [1] at each of its rows, else of logarithms [1]."""

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
    """A fitted table; the store makes a version of it."""

    name: str
    vehicle: Vehicle
    difference: DifferenceCurve
    paper: PaperCurves
    tyre: TyreCurve
    map: PadMap
    level_map: LevelMap
    draws: Draws  # some of the draws of the posterior that the maps are made from
    calibration: Calibration
    budget: TableBudget
    effects: Effects  # drag and rolling resistance as fitted; `vehicle` has other known effects
    noise: dict[str, float]  # noise density of each sensor over long times [unit * s^0.5]
    quality: dict[str, float]  # metrics of the fit
    remarks: tuple[str, ...]  # sentences on decisions of the fit
    provenance: Provenance
    warnings: tuple[PlausibilityWarning, ...] = ()
    spread: FleetScatter | None = None  # scatter between the cars if the table is their mean

    def __repr__(self) -> str:
        eta, pads = self.paper.eta, self.calibration
        low, high = self.paper.decelerations
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
        """f2 of (12) [1] at ``eta`` [1], read as `f1`."""
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
        """Return the record (JSON types) and the curves, maps and draws (named float columns).

        Keys that older tables lack are left out if they are empty, so that digests stay.
        """
        curves = {name: columns(getattr(self, name)) for name in COLUMNS}
        record = asdict(self)
        vehicle_effects = record["vehicle"].pop("effects")
        record["vehicle"]["effects"] = vehicle_effects["parameters"]
        if self.vehicle.motor_odds == Vehicle.motor_odds:  # the default
            del record["vehicle"]["motor_odds"]
        definitions = self.vehicle.effects.defined_in.items()
        record["own_effects"] = {name: asdict(effect) for name, effect in definitions}
        terms = vehicle_effects["terms"]
        record["empirical"] = terms[0] if len(terms) == 1 else terms  # as in older tables
        record["effects"] = {
            effect: {name: asdict(value) for name, value in values.items()}
            for effect, values in self.effect_values.items()
        }
        for name in COLUMNS:
            del record[name]
        for log in record["provenance"]["logs"]:
            del log["sample_time"]
        return {"schema": 1, **json.loads(json.dumps(_without_empty(record)))}, curves

    @property
    def not_sensed(self) -> dict[str, str]:
        """Effects that an ECU cannot take out, each with the signal that the ECU lacks."""
        lacking = not_sensed(self.vehicle.effects)
        if any(warning.code == "wheel_pressures" for warning in self.warnings):
            lacking["wheel_pressures"] = "the pressures of the wheels, which are not p_mc"
        return lacking

    @property
    def fleet(self) -> tuple[TableReference, ...]:
        """The tables of other cars of the model, on which the prior of the fit rests."""
        return self.provenance.parents if self.spread is None else ()

    @property
    def effect_values(self) -> dict[str, dict[str, Value]]:
        """The parameters of ``effects`` with their sigma [SI], by effect and parameter."""
        sigma = self.effects.sigma
        return {
            effect: {name: Value(value, sigma[effect][name]) for name, value in named.items()}
            for effect, named in self.effects.parameters.items()
        }

    @property
    def digest(self) -> str:
        """SHA-256 of the content [hex]."""
        return content_digest(*self.content())


def _without_empty(value: Any) -> Any:
    """Return a record without those of the `_OPTIONAL` keys whose value is empty."""
    if isinstance(value, dict):
        return {k: _without_empty(v) for k, v in value.items() if v or k not in _OPTIONAL}
    return [_without_empty(v) for v in value] if isinstance(value, list | tuple) else value
