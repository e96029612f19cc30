"""Whether this installation computes what it should: a few numbers against truths from elsewhere.

A truth is a definition, a closed form that uses no code of `calib`, the pads of Section IV of the
paper, or what the plant of another program was given that made a sample log.
"""

import math
import re
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.names import G
from calib.base.program import NAME, PROGRAM, VERSION
from calib.car import forces
from calib.car.vehicle import Vehicle
from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.diagnosis import Diagnosis
from calib.estimation.validate import validate
from calib.exports.export import export
from calib.fitting.fit import fit
from calib.help.doctor import environment, needs
from calib.help.samples import sample_logs
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.show.facts import WORDS, Facts
from calib.show.facts import Table as Cells
from calib.store.store import Store
from calib.table.table import Table

_SIMULATED, _BODY, _HIDDEN = "simulation_study", "third_party", "hidden/case_0"
"""Folders of the sample logs: the car of Section IV, a multi-body car, one with a hidden effect."""
_RAMPS = {_SIMULATED: "ramp_noisy.parquet", _BODY: "cal_ramp.parquet"}


def _log(path: str) -> Log:
    return read_log(sample_logs() / path)


def _car(folder: str) -> Vehicle:
    from calib.car.vehicle_file import read_vehicle

    return read_vehicle(sample_logs() / folder / "vehicle.toml")


class Work:
    """An empty folder to ``write`` in, and what several checks need: each is made once."""

    def __init__(self, write: Path) -> None:
        self.write = write
        self.table: Callable[[str], Table] = cache(self._table)
        self.diagnosis: Callable[[], Diagnosis] = cache(self._diagnosis)

    def _table(self, folder: str) -> Table:
        return fit(_car(folder), [_log(f"{folder}/{_RAMPS[folder]}")])

    def _diagnosis(self) -> Diagnosis:
        """The cause of two logs, enough to see it, and one hold-out."""
        searched = [_log(f"{_HIDDEN}/calibration/{name}.parquet") for name in ("ramp", "coast")]
        held = [_log(f"{_HIDDEN}/holdout/stop_a.parquet")]
        return diagnose(_car(_HIDDEN), searched, held)


def _brake_torque(work: Work) -> float:
    front = work.table(_SIMULATED).vehicle.front
    return float(forces.brake_torque(front, 0.4, np.array([50e5]))[0])


def _axle_load(work: Work) -> float:
    return float(forces.axle_loads(work.table(_SIMULATED).vehicle, np.array([0.5]))[0][0])


_CELLS = {"time [s]": 0.0, "p_mc [psi]": 100.0, "a_x [g]": -0.5, "v [km/h]": 90.0} | dict.fromkeys(
    (f"omega_{wheel} [rpm]" for wheel in ("fl", "fr", "rl", "rr")), 600.0
)
_PSI = 0.45359237 * G / 0.0254**2
_SI = {"p_mc": 100.0 * _PSI, "a_x": -0.5 * G, "v": 25.0, "omega_rr": 20.0 * np.pi}


def _read_units(work: Work) -> float:
    """Largest relative error of a log of 200 equal samples, of semicolons and decimal commas."""
    rows = [";".join(map(str, [i / 200.0, *[*_CELLS.values()][1:]])) for i in range(200)]
    path = work.write / "written.csv"
    path.write_text("\n".join([";".join(_CELLS), *rows]).replace(".", ","))
    log = read_log(path)
    return max(float(np.max(np.abs(log[name] / true - 1.0))) for name, true in _SI.items())


def _fitted(axle: str, work: Work) -> float:
    return float(getattr(work.table(_SIMULATED).calibration, f"pad_friction_{axle}").value)


_STEPS, _CONSTANT = f"{_BODY}/hold2_steps_muf25_mur33.parquet", f"{_BODY}/hold1_const_mu30.parquet"


def _stop(axle: str, work: Work) -> float:
    """Mean pad friction of a stop by the table of the multi-body car."""
    found = validate(work.table(_BODY), [_log(_STEPS)])[0].estimate
    pads = found.best.pads_f if axle == "f" else found.best.pads_r
    return float(np.mean(pads.value[found.valid]))


def _torque_error(work: Work) -> float:
    log = _log(_CONSTANT)
    found = validate(work.table(_BODY), [log])[0].estimate
    true = 0.5 * (log.truth["true_Tb_fl"] + log.truth["true_Tb_fr"])[found.valid]
    error = found.best.torque_f.value[found.valid] - true
    return float(np.sqrt(np.mean(error**2) / np.mean(true**2)))


def _changed(work: Work) -> float:
    """Numbers of f2 that a search for the lines WERT finds otherwise in a DCM file."""
    path, table = work.write / "car.dcm", work.table(_SIMULATED)
    stored = Store(work.write / "tables").save(table)
    export(stored, path, unreleased=True, date="2025-01-01")
    text = path.read_bytes().decode("latin-1")
    block = text.split("GRUPPENKENNLINIE sedan_sim_f2 ")[1].split("\nEND")[0]
    lines = re.findall(r"^\s*WERT (.*)$", block, re.MULTILINE)
    found = np.array([float(x) for line in lines for x in line.split()])
    f2 = table.paper.f2
    return float(np.sum(found != f2)) if found.shape == f2.shape else float(f2.size)


def _named(work: Work) -> float:
    found = work.diagnosis()
    return float(
        found.verdict == "named" and [x.name for x in found.effects] == ["aerodynamic_drag"]
    )


def _drag_area(work: Work) -> float:
    (drag,) = (one for one in work.diagnosis().effects if one.name == "aerodynamic_drag")
    return drag.parameters["drag_area"].value


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
    measure: Callable[[Work], float]

    def made(self, work: Work) -> dict[str, Any]:
        """What came out; an error is a finding, which must not end the other checks."""
        value, wrong = math.nan, ""
        try:
            value = float(self.measure(work))
        except Exception as error:
            wrong = f"{type(error).__name__}: {error}"
        told = {one.name: getattr(self, one.name) for one in fields(self)[:-1]}
        held = abs(value - self.expected) <= self.tolerance
        return {
            **told,
            "value": value if math.isfinite(value) else None,
            "held": held,
            "error": wrong,
        }


_TORQUE = 2.0 * 0.40 * 28.84e-4 * 0.1309 * 50e5
_LOAD = 1744.0 * G * (1.6494 + 0.5 * 0.615) / 2.805
DRAG = 0.7444375719787885
_FRONT, _REAR = 0.03, 0.08
"""Relative tolerances of pad friction: those of the torque in the default limits of `validate`."""
_STUDY = f"plant of sample_logs/{_SIMULATED}, Section IV of the paper: pads of 0.4"
_PLANT = f"multi-body plant of sample_logs/{_BODY}"
_ANSWER = f"independent plant, sample_logs/{_HIDDEN}/answer.json"

SUITE = (
    Check("brake_torque", "front brake torque of one wheel at 50 bar, (2) and (3)", "N*m",
          _TORQUE, 1e-9 * _TORQUE, "closed form with Tables I and II of the paper", _brake_torque),
    Check("axle_load", "load of the front axle at 0.5 g, (6)", "N", _LOAD, 1e-9 * _LOAD,
          "balance of moments with Tables I and II of the paper", _axle_load),
    Check("read_units", "largest relative error of a log in psi, g, rpm and km/h", "1", 0.0, 1e-12,
          "definitions of the units", _read_units),
    Check("fit_pads_f", "front pad friction of the table of Section IV", "1", 0.4, 0.4 * _FRONT,
          _STUDY, partial(_fitted, "f")),
    Check("fit_pads_r", "rear pad friction of the table of Section IV", "1", 0.4, 0.4 * _REAR,
          _STUDY, partial(_fitted, "r")),
    Check("stop_pads_f", "front pads of hold2_steps_muf25_mur33.parquet", "1",
          0.25, _FRONT * 0.25, _PLANT, partial(_stop, "f")),
    Check("stop_pads_r", "rear pads of hold2_steps_muf25_mur33.parquet", "1",
          0.33, _REAR * 0.33, _PLANT, partial(_stop, "r")),
    Check("stop_torque", "rms error of the front brake torque of hold1, relative", "1", 0.0, _FRONT,
          f"{_PLANT}, channels true_Tb_*", _torque_error),
    Check("export_dcm", "numbers of f2 that differ in the DCM file", "numbers", 0, 0.5,
          "the table itself, its file read by a search for its lines WERT", _changed),
    Check("drag_named", "1 if aerodynamic drag, and it alone, is named", "1", 1, 0.5,
          _ANSWER, _named),
    Check("drag_size", "drag area that was hidden", "m^2", DRAG, 0.1 * DRAG, _ANSWER, _drag_area),
)  # fmt: skip
"""In the order of the work."""


def qualify(
    checks: Sequence[Check], date: str = "", done: Callable[[], None] = lambda: None
) -> dict[str, Any]:
    """`qualification.json` of a run at ``date`` [UTC, ISO 8601] on this machine.

    All ``checks`` are made on the sample logs, in a temporary folder; ``done`` is called after
    each. Raises InputError without sample logs.
    """
    sample_logs()
    rows = []
    with tempfile.TemporaryDirectory(prefix="brake-cal-qualify-") as folder:
        work = Work(Path(folder))
        for check in checks:
            rows.append(check.made(work))
            done()
    return {
        "schema": 1,
        "tool": NAME,
        "version": VERSION,
        "date": date,
        "verdict": "passed" if all(row["held"] for row in rows) else "failed",
        "environment": environment(),
        "packages": {need.package: need.found for need in needs()},
        "checks": rows,
    }


def facts(document: dict[str, Any]) -> Facts:
    """The document of `qualify` for a terminal and for a page."""
    checks = document["checks"]
    failed = [one["name"] for one in checks if not one["held"]]
    headline = f"{len(failed)} of {len(checks)} checks fail: {', '.join(failed)}."
    heads = ("check", "value", "expected", "tolerance", "unit", "what it is", "truth")
    colours = ["passed" if one["held"] else "failed" for one in checks]
    table = Cells(heads, [_row(one) for one in checks], verdicts=colours)
    machine = {**document["environment"], **document["packages"]}
    return Facts(
        f"Qualification of {PROGRAM} on this machine",
        headline=headline if failed else f"All {len(checks)} checks hold.",
        verdict=document["verdict"],
        word=WORDS[document["verdict"]],
        rows=[("date", document["date"])],
        parts=[
            Facts("A check holds within the tolerance of its expected value", tables=[table]),
            Facts("Machine and packages", rows=[row for row in machine.items() if row[1]]),
        ],
    )


def _row(one: dict[str, Any]) -> tuple[str, ...]:
    value = one["error"] if one["value"] is None else f"{one['value']:.6g}"
    expected, tolerance = f"{one['expected']:.6g}", f"{one['tolerance']:.3g}"
    return one["name"], value, expected, tolerance, one["unit"], one["quantity"], one["truth"]
