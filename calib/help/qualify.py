"""Check that this installation computes right numbers, by truths from elsewhere.

`checks.csv` has the checks. A truth is a closed form that uses no code of `calib`, the pads of
Section IV of the paper, or an input of the other program that simulated a sample log. Pads and
torque have the tolerances of the default limits of `validate`.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from calib.base.names import NAME, PROGRAM, VERSION
from calib.base.plain import rows as rows_of
from calib.car import forces
from calib.car.vehicle import Vehicle
from calib.diagnosis.diagnose import diagnose
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.help.doctor import environment, packages
from calib.help.samples import sample_logs
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.show.facts import FAILED, PASSED, WORDS, Facts, Table

_SIMULATED, _BODY, _HIDDEN = "simulation_study", "third_party", "hidden/case_0"
"""Folders of sample logs: the car of Section IV, a multi-body car, a car with a hidden effect."""


def _log(path: str) -> Log:
    return read_log(sample_logs() / path)


def _car(folder: str) -> Vehicle:
    from calib.car.vehicle_file import read_vehicle

    return read_vehicle(sample_logs() / folder / "vehicle.toml")


def _formulas() -> tuple[float, ...]:
    """Return a brake torque [N m] and an axle load [N] of the car of Section IV."""
    car = _car(_SIMULATED)
    torque = forces.brake_torque(car.front, 0.4, np.array([50e5]))
    return float(torque[0]), float(forces.axle_loads(car, np.array([0.5]))[0][0])


def _pads() -> tuple[float, ...]:
    """Return the front and rear pad friction that a ramp of Section IV gives [1]."""
    table = fit(_car(_SIMULATED), [_log(f"{_SIMULATED}/ramp_noisy.parquet")])
    pads = table.calibration
    return pads.pad_friction_f.value, pads.pad_friction_r.value


def _stops() -> tuple[float, ...]:
    """Return pads of a stop, and the relative rms error of a front torque in another stop [1]."""
    table = fit(_car(_BODY), [_log(f"{_BODY}/cal_ramp.parquet")])
    steps = validate(table, [_log(f"{_BODY}/hold2_steps_muf25_mur33.parquet")])[0].estimate
    pads = (float(np.mean(x.value[steps.valid])) for x in (steps.best.pads_f, steps.best.pads_r))
    log = _log(f"{_BODY}/hold1_const_mu30.parquet")
    constant = validate(table, [log])[0].estimate
    true = 0.5 * (log.truth["true_Tb_fl"] + log.truth["true_Tb_fr"])[constant.valid]
    error = constant.best.torque_f.value[constant.valid] - true
    return *pads, float(np.sqrt(np.mean(error**2) / np.mean(true**2)))


def _cause() -> tuple[float, ...]:
    """Return 1 if the hidden drag alone is named, else 0, and its drag area [m^2]."""
    logs = [_log(f"{_HIDDEN}/calibration/{name}.parquet") for name in ("ramp", "coast")]
    diagnosis = diagnose(_car(_HIDDEN), logs, [_log(f"{_HIDDEN}/holdout/stop_a.parquet")])
    (drag,) = diagnosis.effects
    named = diagnosis.verdict == "named" and drag.name == "aerodynamic_drag"
    return float(named), drag.parameters["drag_area"].value


_Checks = Sequence[Mapping[str, Any]]
_Suite = Mapping[Callable[[], tuple[float, ...]], _Checks]


def _checks(measure: str) -> _Checks:
    """Return the checks of the numbers of a ``measure``, in their order."""
    checks = []
    for row in rows_of("checks.csv", "calib.help"):
        if row.pop("measure") == measure:
            numbers = {key: float(row[key]) for key in ("expected", "tolerance")}
            checks.append({**row, **numbers})
    return checks


SUITE: _Suite = {
    _formulas: _checks("formulas"),
    _pads: _checks("table"),
    _stops: _checks("stops"),
    _cause: _checks("cause"),
}
"""The functions that measure, each with the checks of the numbers that it returns."""


def qualify(
    suite: _Suite, date: str = "", advance: Callable[[], None] = lambda: None
) -> dict[str, Any]:
    """Measure and check all numbers; return the content of `qualification.json`.

    ``date`` is in UTC by ISO 8601. ``advance`` is called after each measurement. Raises InputError
    without sample logs.
    """
    sample_logs()  # raises here, and not within a check
    results: list[dict[str, Any]] = []
    for measure, checks in suite.items():
        values, wrong = (math.nan,) * len(checks), ""
        try:
            values = measure()
        except Exception as error:  # an error fails its checks, and must not end the others
            wrong = f"{type(error).__name__}: {error}"
        for check, value in zip(checks, values, strict=True):
            finite = value if math.isfinite(value) else None
            holds = abs(value - check["expected"]) <= check["tolerance"]
            results.append({**check, "value": finite, "held": holds, "error": wrong})
        advance()
    return {
        "schema": 1,
        "tool": NAME,
        "version": VERSION,
        "date": date,
        "verdict": PASSED if all(row["held"] for row in results) else FAILED,
        "environment": environment(),
        "packages": {need.name: installed for need, installed, _ in packages()},
        "checks": results,
    }


def qualification_facts(document: dict[str, Any]) -> Facts:
    """Return the facts of a document of `qualify`."""
    checks, headline = document["checks"], f"All {len(document['checks'])} checks hold."
    failed = [check["name"] for check in checks if not check["held"]]
    if failed:
        headline = f"{len(failed)} of {len(checks)} checks fail: {', '.join(failed)}."
    heads = ("check", "value", "expected", "tolerance", "unit", "what it is", "truth")
    rows = []
    for check in checks:
        value = check["error"] if check["value"] is None else f"{check['value']:.6g}"
        numbers = value, f"{check['expected']:.6g}", f"{check['tolerance']:.3g}"
        texts = check["unit"], check["quantity"], check["truth"]
        rows.append((check["name"], *numbers, *texts))
    table = Table(heads, rows, verdicts=[PASSED if x["held"] else FAILED for x in checks])
    machine = {**document["environment"], **document["packages"]}
    return Facts(
        f"Qualification of {PROGRAM} on this machine",
        headline=headline,
        verdict=document["verdict"],
        word=WORDS[document["verdict"]],
        rows=[("date", document["date"])],
        parts=[
            Facts("A check holds within the tolerance of its expected value", tables=[table]),
            Facts("Machine and packages", rows=[row for row in machine.items() if row[1]]),
        ],
    )
