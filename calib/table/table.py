"""The look-up table as a value: three look-ups, what they rest on, and how far to trust them.

A table is plain data. ``content`` gives it as one JSON-able record and named float columns;
`from_content` in `calib.table.record_file` builds the same table again. The digest is over that
canonical content, so it does not depend on how a file format packs it.

    record  {schema, name, vehicle, calibration, tyre, effects, noise, quality, provenance}
    curves  {"difference": {eta, D, ...}, "paper": {eta, z, f1, f2, ...},
             "tyre": {slip, force, ...}}
"""

import json
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.digest import content_digest
from calib.physics.effects.empirical import Empirical
from calib.physics.vehicle import Vehicle

Array = NDArray[np.float64]
SCHEMA = 1

MEASURED, INTERPOLATED, EXTRAPOLATED = 0.0, 1.0, 2.0
"""Flags of a cell: seen often enough, between such cells, beyond them."""


@dataclass(frozen=True)
class DifferenceCurve:
    """D(eta) with D(1) = 0, on the branch where eta rises.

    ``eta`` [1]; ``D`` = F_f - F_r [1]; ``lower``, ``upper`` 95 % band [1]; ``count`` blocks seen in
    the cell; ``flag`` MEASURED, INTERPOLATED or EXTRAPOLATED. Shapes (n,).
    """

    eta: Array
    D: Array
    lower: Array
    upper: Array
    count: Array
    flag: Array

    @property
    def peak(self) -> tuple[float, float]:
        """(eta, D) [1] where D is largest in size."""
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
    def decelerations(self) -> tuple[float, float]:
        """Least and greatest z [1] of the rows."""
        return float(np.min(self.z)), float(np.max(self.z))


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
    """A figure with one standard deviation, in SI."""

    value: float
    sigma: float

    @property
    def ci95(self) -> tuple[float, float]:
        """95 % interval, taking the figure as normally distributed."""
        return self.value - 1.96 * self.sigma, self.value + 1.96 * self.sigma


@dataclass(frozen=True)
class Calibration:
    """What the ramps said of the pads.

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
    """Tyre parameters of `calib.physics.tyre` as a Gaussian.

    ``mean`` (k,), ``covariance`` (k, k).
    """

    names: tuple[str, ...]
    mean: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class LogReference:
    """A log that took part: its name, the SHA-256 of its bytes, and what its reader did to it.

    ``notes`` say what was resampled or decoded, and how; empty for a log that was taken as it is.
    """

    name: str
    digest: str
    role: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Provenance:
    """Parents of a table: logs, settings, program version.

    ``identity`` says which car it was made for at a station: serial number, VIN and the like, see
    `calib.station.identity`. A table made without one has none in its record either.
    """

    logs: tuple[LogReference, ...]
    settings: dict[str, float]
    program: str
    identity: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Table:
    """A fitted table, without version: the store gives it one.

    ``effects`` holds drag and rolling resistance with sigma [SI], by effect and parameter; what
    else was known beforehand is in the vehicle, and ``empirical`` a term whose cause is not known;
    ``noise`` the long-run noise density of each sensor [unit * s^0.5]; ``quality`` figures that say
    how good the fit is; ``remarks`` what the user must know, in words.
    """

    name: str
    vehicle: Vehicle
    difference: DifferenceCurve
    paper: PaperCurves
    tyre: TyreCurve
    posterior: TyrePosterior
    calibration: Calibration
    effects: dict[str, dict[str, Value]]
    noise: dict[str, float]
    quality: dict[str, float]
    remarks: tuple[str, ...]
    provenance: Provenance
    empirical: Empirical | None = None

    def content(self) -> tuple[dict[str, Any], dict[str, dict[str, Array]]]:
        """Return the record (JSON-able) and the curves (named float columns)."""
        record = asdict(self)
        if self.empirical is None:
            del record["empirical"]
        for log in record["provenance"]["logs"]:
            if not log["notes"]:  # as tables were written before a reader had anything to say
                del log["notes"]
        if not self.provenance.identity:
            del record["provenance"]["identity"]
        curves = {name: record.pop(name) for name in ("difference", "paper", "tyre")}
        return {"schema": SCHEMA, **json.loads(json.dumps(record))}, curves

    @property
    def digest(self) -> str:
        """SHA-256 of the canonical content [hex]."""
        return content_digest(*self.content())
