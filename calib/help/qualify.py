"""Whether this installation computes what it should: a few numbers against truths from elsewhere.

A truth is a definition, a closed form that uses no code of `calib`, the pads of Section IV of the
paper, or what the plant of another program was given that made a sample log.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.base.names import NAME, PROGRAM, VERSION, G
from calib.car import forces
from calib.car.vehicle import Vehicle
from calib.diagnosis.diagnose import diagnose
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.help.doctor import environment, packages
from calib.help.samples import sample_logs
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.show.facts import WORDS, Facts, Table

_SIMULATED, _BODY, _HIDDEN = "simulation_study", "third_party", "hidden/case_0"
"""Folders of the sample logs: the car of Section IV, a multi-body car, one with a hidden effect."""


def _log(path: str) -> Log:
    return read_log(sample_logs() / path)


def _car(folder: str) -> Vehicle:
    from calib.car.vehicle_file import read_vehicle

    return read_vehicle(sample_logs() / folder / "vehicle.toml")


def _formulas() -> tuple[float, ...]:
    car = _car(_SIMULATED)
    torque = forces.brake_torque(car.front, 0.4, np.array([50e5]))
    return float(torque[0]), float(forces.axle_loads(car, np.array([0.5]))[0][0])


def _pads() -> tuple[float, ...]:
    """Pads of the table of Section IV."""
    table = fit(_car(_SIMULATED), [_log(f"{_SIMULATED}/ramp_noisy.parquet")])
    pads = table.calibration
    return pads.pad_friction_f.value, pads.pad_friction_r.value


def _stops() -> tuple[float, ...]:
    """Pads and torque of a multi-body car in two stops."""
    table = fit(_car(_BODY), [_log(f"{_BODY}/cal_ramp.parquet")])
    steps = validate(table, [_log(f"{_BODY}/hold2_steps_muf25_mur33.parquet")])[0].estimate
    pads = (steps.best.pads_f, steps.best.pads_r)
    log = _log(f"{_BODY}/hold1_const_mu30.parquet")
    constant = validate(table, [log])[0].estimate
    true = 0.5 * (log.truth["true_Tb_fl"] + log.truth["true_Tb_fr"])[constant.valid]
    error = constant.best.torque_f.value[constant.valid] - true
    rms = float(np.sqrt(np.mean(error**2) / np.mean(true**2)))
    return *(float(np.mean(friction.value[steps.valid])) for friction in pads), rms


def _cause() -> tuple[float, ...]:
    """The cause of two logs, enough to see it, and one hold-out."""
    logs = [_log(f"{_HIDDEN}/calibration/{name}.parquet") for name in ("ramp", "coast")]
    diagnosis = diagnose(_car(_HIDDEN), logs, [_log(f"{_HIDDEN}/holdout/stop_a.parquet")])
    (drag,) = diagnosis.effects
    named = diagnosis.verdict == "named" and drag.name == "aerodynamic_drag"
    return float(named), drag.parameters["drag_area"].value


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


_TORQUE = 2.0 * 0.40 * 28.84e-4 * 0.1309 * 50e5
_LOAD = 1744.0 * G * (1.6494 + 0.5 * 0.615) / 2.805
DRAG = 0.7444375719787885
_FRONT, _REAR = 0.03, 0.08
"""Relative tolerances of pad friction: those of the torque in the default limits of `validate`."""
_CLOSED = "closed form with Tables I and II of the paper"
_STUDY = f"plant of sample_logs/{_SIMULATED}, Section IV of the paper: pads of 0.4"
_PLANT = f"multi-body plant of sample_logs/{_BODY}"
_ANSWER = f"independent plant, sample_logs/{_HIDDEN}/answer.json"

_Suite = Mapping[Callable[[], tuple[float, ...]], Sequence[Check]]
SUITE: _Suite = {
    _formulas: (
        Check("brake_torque", "front brake torque of one wheel at 50 bar, (2) and (3)", "N*m",
              _TORQUE, 1e-9 * _TORQUE, _CLOSED),
        Check("axle_load", "load of the front axle at 0.5 g, (6)", "N", _LOAD, 1e-9 * _LOAD,
              _CLOSED),
    ),
    _pads: (
        Check("fit_pads_f", "front pads of the table", "1", 0.4, 0.4 * _FRONT, _STUDY),
        Check("fit_pads_r", "rear pads of the table", "1", 0.4, 0.4 * _REAR, _STUDY),
    ),
    _stops: (
        Check("stop_pads_f", "front pads of hold2", "1", 0.25, _FRONT * 0.25, _PLANT),
        Check("stop_pads_r", "rear pads of hold2", "1", 0.33, _REAR * 0.33, _PLANT),
        Check("stop_torque", "relative rms error of the front brake torque of hold1", "1",
              0.0, _FRONT, f"{_PLANT}, channels true_Tb_*"),
    ),
    _cause: (
        Check("drag_named", "1 if aerodynamic drag, and it alone, is named", "1", 1, 0.5, _ANSWER),
        Check("drag_size", "drag area that was hidden", "m^2", DRAG, 0.1 * DRAG, _ANSWER),
    ),
}  # fmt: skip
"""What measures, and the checks of its numbers; in the order of the work."""


def qualify(
    suite: _Suite, date: str = "", advance: Callable[[], None] = lambda: None
) -> dict[str, Any]:
    """`qualification.json` of a run at ``date`` [UTC, ISO 8601] on this machine.

    All checks are made on the sample logs; ``advance`` is called after each
    measurement. Raises InputError without sample logs.
    """
    sample_logs()
    rows: list[dict[str, Any]] = []
    for measure, checks in suite.items():
        values, wrong = (math.nan,) * len(checks), ""
        try:
            values = measure()
        except Exception as error:  # a finding, which must not end the other checks
            wrong = f"{type(error).__name__}: {error}"
        for check, value in zip(checks, values, strict=True):
            finite = value if math.isfinite(value) else None
            holds = abs(value - check.expected) <= check.tolerance
            rows.append({**vars(check), "value": finite, "held": holds, "error": wrong})
        advance()
    return {
        "schema": 1,
        "tool": NAME,
        "version": VERSION,
        "date": date,
        "verdict": "passed" if all(row["held"] for row in rows) else "failed",
        "environment": environment(),
        "packages": {need.name: installed for need, installed, _ in packages()},
        "checks": rows,
    }


def qualification_facts(document: dict[str, Any]) -> Facts:
    """The document of `qualify` for a terminal and for a page."""
    checks = document["checks"]
    failed = [one["name"] for one in checks if not one["held"]]
    headline = f"{len(failed)} of {len(checks)} checks fail: {', '.join(failed)}."
    heads = ("check", "value", "expected", "tolerance", "unit", "what it is", "truth")
    colours = ["passed" if one["held"] else "failed" for one in checks]
    table = Table(heads, [_row(one) for one in checks], verdicts=colours)
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


def _row(check: dict[str, Any]) -> tuple[str, ...]:
    value = check["error"] if check["value"] is None else f"{check['value']:.6g}"
    expected, tolerance = f"{check['expected']:.6g}", f"{check['tolerance']:.3g}"
    texts = (check[key] for key in ("unit", "quantity", "truth"))
    return check["name"], value, expected, tolerance, *texts
