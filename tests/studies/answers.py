"""What `fit`, `validate` and `station` say of a line, through the command line in this process.

files of the line --> fit, validate, station --> refused? warned of what? pads, D(eta)
"""

import json
import traceback
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typer.testing import CliRunner

from calib.base.errors import BrakeCalError
from calib.car.vehicle import Vehicle
from calib.car.vehicle_file import write_vehicle
from calib.logs.log import Log
from calib.logs.write import write_parquet
from calib.store.store import Store
from cli.main import app
from tests.studies.made_lines import STOPS

Array = NDArray[np.float64]
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
    difference: tuple[Array, Array] | None = None


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
