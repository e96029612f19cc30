"""The look-up table as a value: three look-ups, their origin and their uncertainty.

A table is plain data. ``content`` gives it as one JSON-able record and named float columns;
`from_content` in `calib.store.record_file` builds the same table again. The digest is over that
canonical content, so it does not depend on how a file format packs it.

    record  {schema, name, vehicle, calibration, tyre, effects, noise, quality, provenance}
    curves  {"difference": {eta, D, ...}, "paper": {eta, z, f1, f2, ...},
             "tyre": {slip, force, ...}}
"""

import json
import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.digest import content_digest
from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning
from calib.car.effects.effects import Effects
from calib.car.tyre import PARAMETERS as TYRE
from calib.car.tyre import Tyre
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.run.same_run import Fingerprint, same_as
from calib.table.budget import TableBudget
from calib.table.by_hand import SetByHand
from calib.table.spread import FleetScatter

Array = NDArray[np.float64]
SCHEMA = 1

MEASURED, INTERPOLATED, EXTRAPOLATED, BY_HAND = 0.0, 1.0, 2.0, 3.0
"""Flags of a cell: with enough blocks, between such cells, beyond them, set by a person."""


@dataclass(frozen=True)
class DifferenceCurve:
    """D(eta) with D(1) = 0, on the branch where eta rises.

    ``eta`` [1]; ``D`` = F_f - F_r [1]; ``lower``, ``upper`` 95 % band [1]; ``count`` of blocks in
    the cell; ``flag`` MEASURED, INTERPOLATED, EXTRAPOLATED or BY_HAND. Shapes (n,).
    """

    eta: Array
    D: Array
    lower: Array
    upper: Array
    count: Array
    flag: Array

    @property
    def peak(self) -> tuple[float, float]:
        """(eta, D) [1] where the magnitude of D is largest."""
        i = int(np.argmax(np.abs(self.D)))
        return float(self.eta[i]), float(self.D[i])


@dataclass(frozen=True)
class PaperCurves:
    """f1(eta) and f2(eta) of Fig. 6, on the branch where they are single-valued.

    ``eta`` [1]; ``z`` deceleration of the ramp at that eta [1]; ``f1``, ``f2`` of (11), (12) [1],
    with their 95 % bands; ``count``, ``flag`` as in `DifferenceCurve`. (18) holds in every row.
    Shapes (n,).
    """

    eta: Array
    z: Array
    f1: Array
    f1_lower: Array
    f1_upper: Array
    f2: Array
    f2_lower: Array
    f2_upper: Array
    count: Array
    flag: Array

    @property
    def known(self) -> NDArray[np.bool_]:
        """Rows that rest on measurements or were set by hand, (n,); eta of 1, the first, is one."""
        return np.asarray((self.flag != EXTRAPOLATED) | (np.arange(self.flag.size) == 0))

    @property
    def decelerations(self) -> tuple[float, float]:
        """Least and greatest z [1] of all rows, extrapolated ones too."""
        return float(np.min(self.z)), float(np.max(self.z))

    @property
    def usable(self) -> tuple[float, float]:
        """Least and greatest z [1] of the known rows: the range in which the table is usable."""
        z = self.z[self.known]
        return float(np.min(z)), float(np.max(z))

    @property
    def usable_eta(self) -> tuple[float, float]:
        """Least and greatest eta [1] of the known rows."""
        eta = self.eta[self.known]
        return float(np.min(eta)), float(np.max(eta))


@dataclass(frozen=True)
class TyreCurve:
    """g(slip) common to both axles, at the static mean wheel load. Shapes (n,), all [1]."""

    slip: Array
    force: Array
    lower: Array
    upper: Array
    count: Array
    flag: Array


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
    """Pad parameters estimated from the ramps.

    ``pad_scale`` common factor on the nominal pad friction, from the sum of forces;
    ``pad_log_ratio`` ln of (mu_f/mu_r) over its nominal value; ``pad_friction_f``,
    ``pad_friction_r`` [1].
    """

    pad_scale: Value
    pad_log_ratio: Value
    pad_friction_f: Value
    pad_friction_r: Value


@dataclass(frozen=True)
class TyrePosterior:
    """Posterior of tyre and pads from the ramps, as a Gaussian over named parameters.

    ``names`` those of `calib.model.parameters.RampParameters`; ``mean`` (k,), ``covariance``
    (k, k). ``scatter`` (k, k) is the part of it by which real pads, tyres and radii are less alike
    than the mean takes them: no ramp can tell, and a stop that seems to tells of its own road. The
    record of an older table does not have it.
    """

    names: tuple[str, ...]
    mean: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    scatter: tuple[tuple[float, ...], ...] = ()

    def value(self, name: str) -> float:
        """Mean of a parameter. Raises ValueError if there is none of this name."""
        return self.mean[self.names.index(name)]

    def variance(self, name: str) -> float:
        """Variance of a parameter. Raises ValueError if there is none of this name."""
        at = self.names.index(name)
        return self.covariance[at][at]

    def sigma(self, name: str) -> float:
        """Standard deviation of a parameter. Raises ValueError if there is none of this name."""
        return math.sqrt(self.variance(name))

    @property
    def tyre(self) -> Tyre:
        """The tyre at the mean."""
        return Tyre(**{name: self.value(name) for name in TYRE})


@dataclass(frozen=True)
class LogReference:
    """A log of the fit: its name, the SHA-256 of its bytes, its role, and notes of its reader.

    ``notes`` say what was resampled or decoded, and how; empty for a log that was used unchanged.
    ``fingerprint`` tells a copy of the run from another run; the record of an older table does not
    have it.
    """

    name: str
    digest: str
    role: str
    notes: tuple[str, ...] = ()
    fingerprint: Fingerprint | None = None

    def is_run_of(self, log: Log) -> bool:
        """Whether ``log`` holds this run, also if it was cut, thinned, rounded or resampled.

        Without a fingerprint only an equal file is known.
        """
        if log.digest == self.digest:
            return True
        return self.fingerprint is not None and same_as(self.fingerprint, log)


@dataclass(frozen=True)
class TableReference:
    """A version that a table was made of: its name@version and the SHA-256 of its content."""

    id: str
    digest: str


@dataclass(frozen=True)
class Provenance:
    """Parents of a table: logs, settings, program version.

    ``identity`` of the car at a station: serial number, VIN and the like, see
    `calib.line.station.identity`. ``parents`` versions that it was merged from or derived from, see
    `calib.store`. The record of a table without them does not have the key.
    """

    logs: tuple[LogReference, ...]
    settings: dict[str, float]
    program: str
    identity: dict[str, str] = field(default_factory=dict)
    parents: tuple[TableReference, ...] = ()

    def parent_of(self, log: Log) -> LogReference | None:
        """The log of the fit that ``log`` is, or is a copy of; None for another run."""
        return next((one for one in self.logs if one.is_run_of(log)), None)


@dataclass(frozen=True)
class Table:
    """A fitted table, without version: the store gives it one.

    ``effects`` holds drag and rolling resistance with their sigma; other known effects, empirical
    terms among them, are in the vehicle; ``noise`` the long-run noise density of each sensor
    [unit * s^0.5]; ``quality`` metrics of the fit; ``remarks`` for the user, in words;
    ``warnings`` what speaks against it; ``budget`` what the pads rest on; ``spread`` how the cars
    of a mean table differ; ``by_hand`` what a person set. The record of a table without one of the
    last four, as older ones are, does not have the key.
    """

    name: str
    vehicle: Vehicle
    difference: DifferenceCurve
    paper: PaperCurves
    tyre: TyreCurve
    posterior: TyrePosterior
    calibration: Calibration
    effects: Effects
    noise: dict[str, float]
    quality: dict[str, float]
    remarks: tuple[str, ...]
    provenance: Provenance
    warnings: tuple[PlausibilityWarning, ...] = ()
    budget: TableBudget | None = None
    spread: FleetScatter | None = None
    by_hand: tuple[SetByHand, ...] = ()

    def __repr__(self) -> str:
        eta, (low, high), pads = self.paper.eta, self.paper.decelerations, self.calibration
        logs = ", ".join(f"{log.name} ({log.role})" for log in self.provenance.logs)
        return "\n".join(
            (
                f"Table {self.name}, {self.provenance.program}",
                f"  f1, f2  {eta.size} rows, eta - 1 up to {100.0 * (eta[-1] - 1.0):.3f} %, "
                f"z {low:.2f} to {high:.2f} g",
                f"  pads    front {pads.pad_friction_f}, rear {pads.pad_friction_r} (95 %)",
                f"  logs    {logs}",
            )
        )

    def content(self) -> tuple[dict[str, Any], dict[str, dict[str, Array]]]:
        """Return the record (JSON-able) and the curves (named float columns)."""
        record = asdict(self)
        # the format of older tables: a vehicle with named effects only, and one term beside it
        vehicle = record["vehicle"].pop("effects")
        own = self.vehicle.effects.defined_in
        if own:
            record["own_effects"] = {name: asdict(one) for name, one in own.items()}
        record["vehicle"]["effects"] = vehicle["parameters"]
        if self.vehicle.motor_odds == Vehicle.motor_odds:  # the format of older tables
            del record["vehicle"]["motor_odds"]
        record["effects"] = {
            effect: {name: asdict(value) for name, value in values.items()}
            for effect, values in self.effect_values.items()
        }
        if vehicle["terms"]:
            one = len(vehicle["terms"]) == 1
            record["empirical"] = vehicle["terms"][0] if one else vehicle["terms"]
        for log in record["provenance"]["logs"]:
            for key in ("notes", "fingerprint"):
                if not log[key]:  # the format of older tables: without notes of a reader
                    del log[key]
        for key in ("warnings", "budget", "spread", "by_hand"):
            if not getattr(self, key):  # the format of older tables
                del record[key]
        if not self.posterior.scatter:
            del record["posterior"]["scatter"]
        for key in ("identity", "parents"):
            if not getattr(self.provenance, key):
                del record["provenance"][key]
        curves = {name: record.pop(name) for name in ("difference", "paper", "tyre")}
        return {"schema": SCHEMA, **json.loads(json.dumps(record))}, curves

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
