"""The checks made on this machine: their outcomes, one JSON document, one page."""

import hashlib
import math
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from calib.base.digest import canonical_json
from calib.base.program import NAME, PROGRAM, VERSION
from calib.car.vehicle import Vehicle
from calib.diagnosis.diagnose import Diagnosis, diagnose
from calib.estimation.estimator import Estimate
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.help.doctor import environment, packages
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.show.facts import Facts
from calib.show.facts import Table as Cells
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.table import Table

_SCHEMA = 1
_TOLD = ("name", "quantity", "unit", "expected", "tolerance", "truth")
RAMPS = {"simulation_study": "ramp_noisy.parquet", "third_party": "cal_ramp.parquet"}
"""The folder of a car and its ramp."""


class Material:
    """Logs below ``samples``, and work in the empty folder ``scratch``; made on first use."""

    def __init__(self, samples: Path, scratch: Path) -> None:
        self.samples, self.scratch = samples, scratch
        self._used: set[Path] = set()
        # one result each for as long as this object lives; an error is not kept
        self.log = cache(lambda file: read_log(self._file(file)))
        self.table: Callable[[str], Table] = cache(self._table)
        self.stop: Callable[..., Estimate] = cache(self._stop)
        self.diagnosis: Callable[[str], Diagnosis] = cache(self._diagnosis)

    def files(self) -> dict[str, str]:
        """SHA-256 [hex] of every sample file that was used so far, by path below ``samples``."""
        return {
            path.relative_to(self.samples).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(self._used)
        }

    def vehicle(self, file: str) -> Vehicle:
        """The vehicle of a file below ``samples``."""
        from calib.car.vehicle_file import read_vehicle

        return read_vehicle(self._file(file))

    def stored(self) -> Stored:
        """The table of Section IV in a store."""
        return Store(self.scratch / "tables").save(self.table("simulation_study"))

    def _file(self, file: str) -> Path:
        self._used.add(self.samples / file)
        return self.samples / file

    def _table(self, folder: str) -> Table:
        return fit(self.vehicle(f"{folder}/vehicle.toml"), [self.log(f"{folder}/{RAMPS[folder]}")])

    def _stop(self, stop: str, vehicle: str = "vehicle.toml") -> Estimate:
        """One hold-out by the table of its folder."""
        folder = stop.split("/")[0]
        told = self.vehicle(f"{folder}/{vehicle}")
        return validate(self.table(folder), [self.log(stop)], told)[0].estimate

    def _diagnosis(self, case: str) -> Diagnosis:
        """A hidden case by two logs, enough to see its cause, and one hold-out."""
        searched = [self.log(f"{case}/calibration/{name}.parquet") for name in ("ramp", "coast")]
        held = self.log(f"{case}/holdout/stop_a.parquet")
        return diagnose(self.vehicle(f"{case}/vehicle.toml"), searched, [held])


@dataclass(frozen=True)
class Check:
    """A ``quantity`` and what must come out: ``expected`` +- ``tolerance`` above zero [``unit``].

    ``truth``: where the expected value comes from.
    """

    name: str
    quantity: str
    unit: str
    expected: float
    tolerance: float
    truth: str
    measure: Callable[[Material], float]


@dataclass(frozen=True)
class Outcome:
    """A check and its ``value`` [unit of the check]; None where it ended with an ``error``."""

    check: Check
    value: float | None
    error: str = ""

    @property
    def _deviation(self) -> float:
        """Value less the expected one [tolerances]."""
        value = math.nan if self.value is None else self.value
        return (value - self.check.expected) / self.check.tolerance

    @property
    def held(self) -> bool:
        """Whether the value is within the tolerance."""
        return abs(self._deviation) <= 1.0

    @property
    def rounded(self) -> int | None:
        """Deviation in whole tolerances, equal where machines differ by rounding only."""
        return round(self._deviation) if math.isfinite(self._deviation) else None


@dataclass(frozen=True)
class Qualification:
    """The outcomes, and the SHA-256 [hex] of each sample file that they rest on."""

    outcomes: tuple[Outcome, ...]
    files: dict[str, str]

    @property
    def failed(self) -> tuple[Outcome, ...]:
        """The outcomes that do not hold."""
        return tuple(outcome for outcome in self.outcomes if not outcome.held)

    @property
    def verdict(self) -> str:
        """`passed` where every check held, else `failed`."""
        return "failed" if self.failed else "passed"

    @property
    def digest(self) -> str:
        """SHA-256 [hex] over the outcomes, each rounded to its tolerance.

        Equal on machines whose libraries round differently, but for a value between two steps.
        """
        results = [
            [o.check.name, o.check.expected, o.check.tolerance, o.held, o.rounded]
            for o in self.outcomes
        ]
        return hashlib.sha256(canonical_json({"schema": _SCHEMA, "results": results})).hexdigest()


def qualify(checks: Iterable[Check], done: Callable[[], None] = lambda: None) -> Qualification:
    """Make all ``checks`` on the sample logs, in a temporary folder; an error fails its check.

    ``done`` is called after each. Raises InputError without sample logs.
    """
    samples, outcomes = sample_logs(), []
    with tempfile.TemporaryDirectory(prefix="brake-cal-qualify-") as scratch:
        material = Material(samples, Path(scratch))
        for check in checks:
            try:
                outcomes.append(Outcome(check, float(check.measure(material))))
            except Exception as error:  # a finding, which must not end the others
                outcomes.append(Outcome(check, None, f"{type(error).__name__}: {error}"))
            done()
        return Qualification(tuple(outcomes), material.files())


def to_dict(found: Qualification, date: str) -> dict[str, Any]:
    """`qualification.json` of a run at ``date`` [UTC, ISO 8601] on this machine."""
    return {
        "schema": _SCHEMA,
        "tool": NAME,
        "version": VERSION,
        "date": date,
        "verdict": found.verdict,
        "digest": found.digest,
        "environment": environment(),
        "packages": packages(),
        "checks": [
            {name: getattr(o.check, name) for name in _TOLD}
            | {"value": o.value, "held": o.held, "error": o.error}
            for o in found.outcomes
        ],
        "files": found.files,
    }


def facts(found: Qualification, document: dict[str, Any]) -> Facts:
    """What `to_dict` says, for a terminal and for a page."""
    number, names = len(found.outcomes), ", ".join(one.check.name for one in found.failed)
    headline = f"{len(found.failed)} of {number} checks fail: {names}."
    heads = ("check", "expected", "result", "value", "tolerance", "unit")
    return Facts(
        f"Qualification of {PROGRAM} on this machine",
        headline=headline if names else f"All {number} checks hold.",
        verdict=found.verdict,
        word=found.verdict.upper(),
        rows=[
            ("Date", document["date"]),
            ("Results, SHA-256", found.digest),
            *((name.capitalize(), text) for name, text in document["environment"].items() if text),
        ],
        tables=[
            Cells(
                heads,
                [_row(one) for one in found.outcomes],
                "A check holds within the tolerance of its expected value.",
                ["passed" if one.held else "failed" for one in found.outcomes],
            )
        ],
        parts=[
            Facts(
                "What each check computes, and where its truth comes from",
                rows=[
                    (c.name, f"{c.quantity} [{c.unit}]. Truth: {c.truth}.")
                    for c in (one.check for one in found.outcomes)
                ],
            ),
            Facts("Packages", rows=list(document["packages"].items())),
            Facts("Sample logs, with their SHA-256", rows=list(found.files.items()), folded=True),
        ],
    )


def _row(one: Outcome) -> tuple[str, ...]:
    check, value = one.check, one.error if one.value is None else f"{one.value:.6g}"
    result = "holds" if one.held else "fails"
    return check.name, f"{check.expected:.6g}", result, value, f"{check.tolerance:.3g}", check.unit
