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
from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.diagnosis import Diagnosis
from calib.estimation.estimator import Estimate
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.help.doctor import environment, packages
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.show.facts import WORDS, Facts
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

    def deviation(self, value: float | None) -> float:
        """A value less the expected one [tolerances]; it holds up to 1."""
        return math.nan if value is None else (value - self.expected) / self.tolerance


def qualify(
    checks: Iterable[Check], date: str = "", done: Callable[[], None] = lambda: None
) -> dict[str, Any]:
    """`qualification.json` of a run at ``date`` [UTC, ISO 8601] on this machine.

    All ``checks`` are made on the sample logs, in a temporary folder; an error fails its check.
    ``done`` is called after each. The digest is over the results in whole tolerances, so that it is
    equal on machines whose libraries round differently, but for a value between two steps. Raises
    InputError without sample logs.
    """
    samples, rows, digested = sample_logs(), [], []
    with tempfile.TemporaryDirectory(prefix="brake-cal-qualify-") as scratch:
        material = Material(samples, Path(scratch))
        for check in checks:
            value, wrong = None, ""
            try:
                value = float(check.measure(material))
            except Exception as error:  # a finding, which must not end the others
                wrong = f"{type(error).__name__}: {error}"
            deviation = check.deviation(value)
            held, rounded = abs(deviation) <= 1.0, None
            if math.isfinite(deviation):
                rounded = round(deviation)
            told = {name: getattr(check, name) for name in _TOLD}
            rows.append({**told, "value": value, "held": held, "error": wrong})
            digested.append([check.name, check.expected, check.tolerance, held, rounded])
            done()
        files = material.files()
    results = canonical_json({"schema": _SCHEMA, "results": digested})
    return {
        "schema": _SCHEMA,
        "tool": NAME,
        "version": VERSION,
        "date": date,
        "verdict": "passed" if all(row["held"] for row in rows) else "failed",
        "digest": hashlib.sha256(results).hexdigest(),
        "environment": environment(),
        "packages": packages(),
        "checks": rows,
        "files": files,
    }


def facts(document: dict[str, Any]) -> Facts:
    """The document of `qualify` for a terminal and for a page."""
    checks = document["checks"]
    failed = [one["name"] for one in checks if not one["held"]]
    headline = f"{len(failed)} of {len(checks)} checks fail: {', '.join(failed)}."
    heads = ("check", "expected", "result", "value", "tolerance", "unit")
    environment = [(name, text) for name, text in document["environment"].items() if text]
    about = ((x["name"], f"{x['quantity']} [{x['unit']}]. Truth: {x['truth']}.") for x in checks)
    colours = ["passed" if one["held"] else "failed" for one in checks]
    table = Cells(heads, [_row(one) for one in checks], verdicts=colours)
    return Facts(
        f"Qualification of {PROGRAM} on this machine",
        headline=headline if failed else f"All {len(checks)} checks hold.",
        verdict=document["verdict"],
        word=WORDS[document["verdict"]],
        rows=[("date", document["date"]), ("SHA-256 of the results", document["digest"])],
        parts=[
            Facts("A check holds within the tolerance of its expected value", tables=[table]),
            Facts("What each check computes, and where its truth comes from", rows=list(about)),
            Facts("Machine and packages", rows=[*environment, *document["packages"].items()]),
            Facts("Sample logs, with their SHA-256", rows=[*document["files"].items()],
                  folded=True),
        ],
    )  # fmt: skip


def _row(one: dict[str, Any]) -> tuple[str, ...]:
    value = one["error"] if one["value"] is None else f"{one['value']:.6g}"
    expected, tolerance = f"{one['expected']:.6g}", f"{one['tolerance']:.3g}"
    return one["name"], expected, "holds" if one["held"] else "fails", value, tolerance, one["unit"]
