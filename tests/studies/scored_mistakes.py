"""One line with a mistake and without it, through the command line in this process: what the
commands said, and how far the answer moved. Material, silent and named are as in `mistakes`.

files of the line --> fit, validate, station --> refused? warned of what? pads, D(eta)
"""

import json
import math
import re
import tempfile
import traceback
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from typer.testing import CliRunner

from calib.base.errors import BrakeCalError
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.logs.write import write_parquet
from calib.store.store import Store
from cli.main import app
from tests.studies.made_lines import RUNS, STOPS, line, recorded
from tests.studies.made_mistakes import KINDS
from tests.support.vehicle_files import write_vehicle

Pads = tuple[float, float]

COMMANDS = ("fit", "validate", "station")


@dataclass(frozen=True)
class Said:
    """What one command said: exit ``code``, ``refusal`` where it ended with an error.

    ``codes`` of its warnings, and of the station's checks that failed or warn; ``causes`` the first
    two of each warning; ``crash`` a traceback, where the program broke.
    """

    code: int
    refusal: str = ""
    codes: tuple[str, ...] = ()
    causes: tuple[str, ...] = ()
    crash: str = ""

    @property
    def anything(self) -> bool:
        """Whether a person at the station had a reason to look."""
        return self.code != 0 or bool(self.codes)

    @property
    def words(self) -> str:
        """All in which a cause may be named."""
        return "\n".join((self.refusal, *self.causes))


@dataclass(frozen=True)
class Answer:
    """What the program made of a line: by command what it said; pads [1] by run; D over eta."""

    said: dict[str, Said]
    pads: dict[str, Pads] = field(default_factory=dict)
    difference: tuple[np.ndarray, np.ndarray] | None = None


def answer(vehicle: Vehicle, logs: dict[str, Log], folder: Path) -> Answer:
    """Write the line into ``folder``, an empty one, without its truth, and run the commands."""
    write_vehicle(vehicle, folder / "vehicle.toml")
    for name, log in logs.items():
        write_parquet(replace(log, truth={}), folder / f"{name}.parquet")
    ramp, coast, *stops = (folder / f"{name}.parquet" for name in ("ramp", "coast", *STOPS))
    car, store = ("--vehicle", folder / "vehicle.toml"), ("--store", folder / "tables")
    said, pads, difference = {}, {}, None
    said["fit"], document = run("fit", ramp, coast, *car, *store)
    if document:
        calibration = document["calibration"]
        pads["ramp"] = tuple(calibration[f"pad_friction_{a}"]["value"] for a in "fr")
        curve = Store(folder / "tables").load(vehicle.name).table.difference
        difference = curve.eta, curve.D
        said["validate"], document = run("validate", vehicle.name, *stops, *store)
        pads |= of_stops(document)
    elsewhere = ("--store", folder / "of_station", "--out", folder / "out")
    said["station"], _ = run("station", ramp, *stops, "--coast", coast, *car, *elsewhere)
    return Answer(said, pads, difference)


def of_stops(document: dict[str, Any]) -> dict[str, Pads]:
    """Mean pads of the stops that have an estimate."""
    found = {
        name: tuple(log["figures"][f"pad_friction_{a}"] for a in "fr")
        for name, log in zip(STOPS, document.get("logs", ()), strict=False)
    }
    return {name: pair for name, pair in found.items() if None not in pair}


def run(*words: object) -> tuple[Said, dict[str, Any]]:
    """Run one command with ``--json``; what it said, and its document, {} without one."""
    ran = CliRunner().invoke(app, [*map(str, words), "--json"])
    error = ran.exception
    if isinstance(error, BrakeCalError):
        return Said(error.exit_code, refusal=str(error)), {}
    if error is not None and not isinstance(error, SystemExit):
        return Said(1, crash="".join(traceback.format_exception(error)[-3:])), {}
    try:
        document = json.loads(ran.stdout)
    except json.JSONDecodeError:
        return Said(ran.exit_code, refusal=ran.stderr), {}
    warnings = document.get("warnings") or []
    checks = [
        f"{check['figure']} {check['verdict']}"
        for check in document.get("checks", ())
        if check["verdict"] in ("warning", "failed")
    ]
    failed = [
        f"{limit['figure']} failed"
        for log in document.get("logs", ())
        for limit in log.get("limits", ())
        if limit["passed"] is False
    ]
    codes = [warning["code"] for warning in warnings]
    causes = [cause for warning in warnings for cause in warning["causes"][:2]]
    return Said(ran.exit_code, "", (*codes, *checks, *failed), tuple(causes)), document


Errors = dict[tuple[str, str], float]
"""ln of pads over truth by run and axle."""

PADS, CURVE = 0.05, 0.02
"""Errors of the pads [1] and of D [1] from which a mistake is material."""


@dataclass(frozen=True)
class Row:
    """One line: the mistake and its size, how far it moved pads and D, what was said.

    ``off`` largest error of the pads without the mistake, front and rear [1].
    """

    number: int
    kind: str
    size: str
    off: tuple[float, float]
    pads: float
    curve: float
    clean: dict[str, Said]
    said: dict[str, Said]

    @property
    def moved(self) -> bool:
        """Whether the answer is wrong because of the mistake."""
        return self.pads > PADS or self.curve > CURVE

    @property
    def refused(self) -> bool:
        """Whether a command ended with an error that the line without the mistake did not get."""
        return any(s.code > 1 or s.crash for s in self.said.values()) and not any(
            s.code > 1 or s.crash for s in self.clean.values()
        )

    @property
    def material(self) -> bool:
        """Whether it should have been seen."""
        return self.moved or self.refused or KINDS[self.kind].counts

    @property
    def caught(self) -> bool:
        """Whether any command said a word."""
        return any(said.anything for said in self.said.values())

    @property
    def named(self) -> bool:
        """Whether any command named the cause."""
        words = re.compile(KINDS[self.kind].named, re.IGNORECASE)
        return any(words.search(said.words) for said in self.said.values())

    def news(self, command: str) -> bool:
        """Whether the command said what it does not say without the mistake."""
        said, before = self.said[command], self.clean.get(command, Said(0))
        return said.code > before.code or bool(set(said.codes) - set(before.codes))

    def met(self, command: str) -> bool:
        """Whether the command could have seen it."""
        if command == "fit":
            return "ramp" in KINDS[self.kind].runs
        return command in self.said


def tried(job: tuple[int, int, str]) -> Row:
    """Draw the line of a job (seed, number, kind), run it without the mistake and with it."""
    seed, number, name = job
    rng = np.random.default_rng([seed, number])
    good = line(rng, 1_000_000 * seed + 100 * number)
    if KINDS[name].needs_v:
        good = replace(good, sensors=replace(good.sensors, with_v=True))
    mistake = KINDS[name].make(rng)
    bad = mistake.line(good)
    logs = {run: recorded(run, good.runs[run], good.sensors) for run in RUNS}
    others = {
        run: logs[run]
        if bad.runs[run] is good.runs[run]
        else recorded(run, bad.runs[run], bad.sensors)
        for run in RUNS
    }
    others = mistake.logs(others)
    clean, made = answered(good.file, logs), answered(bad.file, others)
    before = errors(clean, logs)
    pads, curve = moved_pads(before, errors(made, others)), moved_curve(clean, made)
    return Row(number, name, mistake.size, largest(before), pads, curve, clean.said, made.said)


def answered(vehicle: Vehicle, logs: dict[str, Log]) -> Answer:
    """The answer on files in a folder that is gone afterwards."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return answer(vehicle, logs, Path(folder))


def errors(of: Answer, logs: dict[str, Log]) -> Errors:
    """ln of pads over truth by run and axle."""
    return {
        (run, axle): math.log(mu / float(np.mean(logs[run].truth[f"true_mu_pad_{axle}"])))
        for run, pair in of.pads.items()
        for axle, mu in zip("fr", pair, strict=True)
    }


def largest(clean: Errors) -> tuple[float, float]:
    """The largest error over the runs, front and rear [1]; nan without any."""
    front, rear = (
        max((abs(e) for (_, side), e in clean.items() if side == axle), default=math.nan)
        for axle in "fr"
    )
    return math.expm1(front), math.expm1(rear)


def moved_pads(clean: Errors, made: Errors) -> float:
    """The largest error that the mistake brought [1]: of the truth and of the good answer."""
    both = [min(abs(e), abs(e - clean[key])) for key, e in made.items() if key in clean]
    return math.expm1(max(both, default=0.0))


def moved_curve(clean: Answer, made: Answer) -> float:
    """How far D moved at most, where both tables know it [1]."""
    if clean.difference is None or made.difference is None:
        return 0.0
    (eta, D), (other, moved) = clean.difference, made.difference
    common = eta[(eta >= other[0]) & (eta <= other[-1])]
    apart = np.interp(common, eta, D) - np.interp(common, other, moved)
    return float(np.max(np.abs(apart), initial=0.0))
