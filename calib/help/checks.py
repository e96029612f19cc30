"""The checks of `brake-cal qualify`: numbers of the program against truths from elsewhere.

A truth is a definition, a closed form that uses no code of `calib`, the pads of Section IV of the
paper, or what the plant of another program was given that made a sample log.
"""

import re
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.base import random_effects, units
from calib.base.errors import BrakeCalError
from calib.car import forces
from calib.estimation import baselines
from calib.estimation.limits import Limit
from calib.estimation.validate import validate
from calib.exports.export import export
from calib.exports.read import read_back
from calib.help.qualify import RAMPS, Check, Material
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.store.store import Store

# Single functions. Tables I and II of the paper: mass, centre of gravity, front brake.
M, L_F, L_R, H, G = 1744.0, 1.1556, 1.6494, 0.615, 9.80665
_CAR = "simulation_study/vehicle.toml"
PRESSURE, Z = 50e5, 0.5
_TORQUE = 2.0 * 0.40 * 28.84e-4 * 0.1309 * PRESSURE
_LOAD = M * G * (L_R + Z * H) / (L_F + L_R)
_PSI = 0.45359237 * G / 0.0254**2
_ADAPTED = 0.08 * (1.0 - 0.99**500)  # each step leaves 0.99 of the error
_THINGS = np.array([[0.36], [0.39], [0.40], [0.45]])
_BETWEEN = 0.0014 - 0.0001
"""Sample variance of `_THINGS`, 0.0042/3, less their own of 0.01^2: the maximum of the restricted
likelihood where all own variances are equal."""


def _torque(material: Material) -> float:
    front = material.vehicle(_CAR).front
    return float(forces.brake_torque(front, front.pad_friction, np.array([PRESSURE]))[0])


def _constraint(material: Material) -> float:
    """(18) by loads from the balance of moments."""
    z, D = np.linspace(0.0, 0.9, 10), np.linspace(-0.1, 0.1, 10)
    f1, f2 = forces.paper_curves(material.vehicle(_CAR), z, D)
    front = (L_R + z * H) / (L_F + L_R)
    return float(np.max(np.abs(f1 * front + f2 * (1.0 - front))) + np.max(np.abs(f1 - f2 - D)))


def _adapted(material: Material) -> float:
    u = np.full(500, -200.0)
    gamma, dt = 0.01 / (200.0**2 * 0.005), 0.005
    return float(baselines.gradient(0.08 * u, u, gamma, dt)[-1])


# Logs that the checks write: 200 equal samples, and what they are by the definitions of the units.
_UNITS = {"time": "s", "p_mc": "psi", "a_x": "g", "omega_fl": "rpm", "omega_fr": "rpm",
         "omega_rl": "rpm", "omega_rr": "rpm", "v": "km/h"}  # fmt: skip
_WRITTEN = (100.0, -0.5, 600.0, 600.0, 600.0, 600.0, 90.0)
_TRUE = {"p_mc": 100.0 * _PSI, "a_x": -0.5 * G, "omega_rr": 20.0 * np.pi, "v": 25.0}


def _text(separator: str = ",", decimal: str = ".") -> str:
    head = separator.join(f"{name} [{unit}]" for name, unit in _UNITS.items())
    lines = [(i / 200.0, *_WRITTEN) for i in range(200)]
    rows = [separator.join(str(x).replace(".", decimal) for x in line) for line in lines]
    return "\n".join((head, *rows)) + "\n"


def _read_error(separator: str, decimal: str, material: Material) -> float:
    path = material.scratch / "written.csv"
    path.write_text(_text(separator, decimal))
    log = read_log(path)
    return float(max(np.max(np.abs(log[name] / true - 1.0)) for name, true in _TRUE.items()))


def _broken_logs(material: Material) -> float:
    """A log is refused where the error names what is wrong in it."""
    whole = (material.samples / RAMP).read_bytes()
    text = _text()
    backwards = text.splitlines()
    backwards[5], backwards[9] = backwards[9], backwards[5]
    refused = 0
    for name, content, word in (
        ("cut_in_half.parquet", whole[: len(whole) // 2], "cut_in_half"),
        ("no_such_unit.csv", text.replace("[psi]", "[furlong]").encode(), "furlong"),
        ("no_unit.csv", text.replace("p_mc [psi]", "p_mc").encode(), "unit"),
        ("time_runs_back.csv", "\n".join(backwards).encode(), "time"),
    ):
        path = material.scratch / name
        path.write_bytes(content)
        try:
            read_log(path)
        except BrakeCalError as error:
            refused += word in str(error)
    return float(refused)


# A ramp becomes a table.
RAMP = f"third_party/{RAMPS['third_party']}"
AT, NEAR = 0.3, 0.02
"""Deceleration at which D is compared, and half the range of samples that are averaged [1]."""


def _pads(folder: str, axle: str, material: Material) -> float:
    pads = material.table(folder).calibration
    return (pads.pad_friction_f if axle == "f" else pads.pad_friction_r).value


def _pad_error(axle: str, material: Material) -> float:
    """Pad friction of the table over the mean true one of the braked ramp, less 1."""
    log: Log = material.log(RAMP)
    true = np.mean(log.truth[f"true_mu_pad_{axle}"][log["p_mc"] > 5e5])
    return _pads("third_party", axle, material) / float(true) - 1.0


def _split_error(material: Material) -> float:
    log, curve = material.log(RAMP), material.table("third_party").paper
    near = np.abs(-log["a_x"] / G - AT) < NEAR
    front, rear = (
        np.abs(log.truth[f"true_Fx_{side}l"] + log.truth[f"true_Fx_{side}r"])
        / (log.truth[f"true_Fz_{side}l"] + log.truth[f"true_Fz_{side}r"])
        for side in "fr"
    )
    return float(np.interp(AT, curve.z, curve.f1 - curve.f2) - np.mean((front - rear)[near]))


# Stops are judged by a table.
_STOPS = {
    "third_party/hold1_const_mu30.parquet": 0.30,
    "third_party/hold2_steps_muf25_mur33.parquet": 0.25,
    "third_party/hold4_driver_mu28.parquet": 0.28,
}
"""Hold-outs of the multi-body car, with the friction of the front pads that the plant had."""
CONSTANT, STEPS, _ = _STOPS
_STOP = "simulation_study/stop_noisy.parquet"
_WRONG = "vehicle_wrong_pads.toml"
"""It says 0.5 and 0.6 where the plant has 0.4."""


def _stop_pads(stop: str, axle: str, told: str, material: Material) -> float:
    found = material.stop(stop, told)
    pads = found.best.pads_f if axle == "f" else found.best.pads_r
    return float(np.mean(pads.value[found.valid]))


def _stop_torque(material: Material) -> float:
    found, log = material.stop(CONSTANT), material.log(CONSTANT)
    true = 0.5 * (log.truth["true_Tb_fl"] + log.truth["true_Tb_fr"])[found.valid]
    error = found.best.torque_f.value[found.valid] - true
    return float(np.sqrt(np.mean(error**2) / np.mean(true**2)))


def _outside(material: Material) -> float:
    outside: list[NDArray[np.bool_]] = []
    for stop, true in _STOPS.items():
        e = material.stop(stop)
        outside.append(((e.best.pads_f.lower > true) | (e.best.pads_f.upper < true))[e.valid])
    return float(np.mean(np.concatenate(outside)))


def _failed(material: Material) -> float:
    table = material.table("third_party")
    impossible = (Limit("pad_friction_f", 0.35, None),)
    broken = validate(table, [material.log(CONSTANT)], None, impossible)
    fitted = validate(table, [material.log(RAMP)], None, ())
    return float(sum(not result.passed for result in (*broken, *fitted)))


# Tables are stored and handed out.
def _dcm(material: Material, name: str) -> tuple[Path, list[float]]:
    """An export, and the numbers of f2 that a search for the lines WERT finds in it."""
    path = material.scratch / name
    export(material.stored(), path, unreleased=True, date="2025-01-01")
    text = path.read_bytes().decode("latin-1")
    block = text.split("GRUPPENKENNLINIE sedan_sim_f2 ")[1].split("\nEND")[0]
    lines = re.findall(r"^\s*WERT (.*)$", block, re.M)
    return path, [float(x) for line in lines for x in line.split()]


def _changed(material: Material) -> float:
    found = np.array(_dcm(material, "car.dcm")[1])
    table = material.table("simulation_study").paper.f2
    return float(np.sum(found != table)) if found.shape == table.shape else float(table.size)


def _damaged(material: Material) -> float:
    (cut, _), (edited, values) = (_dcm(material, name) for name in ("cut.dcm", "edited.dcm"))
    cut.write_bytes(cut.read_bytes()[:-2000])
    text = edited.read_bytes()
    edited.write_bytes(text.replace(repr(values[-1]).encode(), repr(values[-1] + 1e-3).encode()))
    stored = material.stored()
    store = Store(material.scratch / "damaged")
    curve = next(store.save(stored.table).path.glob("*.parquet"))
    content = bytearray(curve.read_bytes())
    content[len(content) // 4] ^= 1
    curve.chmod(0o644)
    curve.write_bytes(content)
    refused = sum(not _unchanged(path) for path in (cut, edited))
    try:
        store.load(stored.name)
    except BrakeCalError:
        refused += 1
    return float(refused)


def _unchanged(path: Path) -> bool:
    try:
        return read_back(path).unchanged is True
    except BrakeCalError:
        return False


# Hidden causes are named.
DRAG = 0.7444375719787885
HIDDEN, NOTHING = "hidden/case_0", "hidden/case_5"


def _named(material: Material) -> float:
    found = material.diagnosis(HIDDEN)
    names = [one.name for one in found.effects]
    return float(found.verdict == "named" and names == ["aerodynamic_drag"])


def _drag(material: Material) -> float:
    (drag,) = (e for e in material.diagnosis(HIDDEN).effects if e.name == "aerodynamic_drag")
    return drag.parameters["drag_area"].value


_EXACT = 1e-9
"""Relative tolerance of a closed form: far above rounding, far below any error of a formula."""
_COUNT = 0.5
"""Tolerance of what is counted: it must be exact."""
_FRONT, _REAR = 0.03, 0.08
"""Relative tolerances of pad friction: those of the torque in the default limits of `validate`."""

_CLOSED = "closed form with Tables I and II of the paper"
_BY_DEFINITION = "definitions of the units"
_STUDY = "plant of sample_logs/simulation_study, Section IV of the paper: pads of 0.4"
_BODY = "multi-body plant of sample_logs/third_party, channels true_mu_pad_*"
_FORCES = "multi-body plant of sample_logs/third_party, channels true_Fx_* and true_Fz_*"
_TORQUES = "multi-body plant of sample_logs/third_party, channels true_Tb_*"
_ANSWER = "independent plant, sample_logs/{}/answer.json"

SUITE = (
    Check("unit_psi", "100 psi", "Pa", 100.0 * _PSI, 1e-3,
          "definition of pound, inch and standard gravity",
          lambda _: float(units.to_si(100.0, "psi", "Pa"))),
    Check("brake_torque", "front brake torque of one wheel at 50 bar, (2) and (3)", "N*m",
          _TORQUE, _EXACT * _TORQUE, _CLOSED, _torque),
    Check("axle_load", "load of the front axle at 0.5 g, (6)", "N", _LOAD, _EXACT * _LOAD,
          "balance of moments with Tables I and II of the paper",
          lambda m: float(forces.axle_loads(m.vehicle(_CAR), np.array([Z]))[0][0])),
    Check("constraint", "largest violation of (18) and of D = f1 - f2", "1", 0.0, _EXACT,
          "equation (18) of the paper", _constraint),
    Check("adaptive_law", "theta of (25) after 500 equal steps", "1", _ADAPTED, _EXACT,
          "closed form: a geometric series", _adapted),
    Check("spread_of_cars", "variance between four cars measured alike", "1",
          _BETWEEN, 1e-3 * _BETWEEN, "closed form: sample variance less own variance",
          lambda _: float(
              random_effects.random_effects(_THINGS, np.full((4, 1), 1e-4)).between[0])),
    Check("read_units", "largest relative error of a log in psi, g, rpm and km/h", "1", 0.0, 1e-12,
          _BY_DEFINITION, partial(_read_error, ",", ".")),
    Check("read_dialect", "the same log with semicolons and decimal commas", "1", 0.0, 1e-12,
          _BY_DEFINITION, partial(_read_error, ";", ",")),
    Check("broken_logs", "refused of four broken logs", "files", 4, _COUNT,
          "each file breaks one stated rule of a log", _broken_logs),
    Check("fit_pads_f", "front pad friction of the table of Section IV", "1", 0.4, 0.4 * _FRONT,
          _STUDY, partial(_pads, "simulation_study", "f")),
    Check("fit_pads_r", "rear pad friction of the table of Section IV", "1", 0.4, 0.4 * _REAR,
          _STUDY, partial(_pads, "simulation_study", "r")),
    Check("fit_body_pads_f", "relative error of the front pads of the multi-body car's table", "1",
          0.0, _FRONT, _BODY, partial(_pad_error, "f")),
    Check("fit_body_pads_r", "relative error of the rear pads of the multi-body car's table", "1",
          0.0, _REAR, _BODY, partial(_pad_error, "r")),
    Check("fit_split", "error of D = f1 - f2 at 0.3 g of the multi-body car's table", "1",
          0.0, 0.02, _FORCES, _split_error),
    Check("stop_mu25_mu33_f", "front pads of hold2_steps_muf25_mur33.parquet", "1",
          0.25, _FRONT * 0.25, _BODY, partial(_stop_pads, STEPS, "f", "vehicle.toml")),
    Check("stop_mu25_mu33_r", "rear pads of hold2_steps_muf25_mur33.parquet", "1",
          0.33, _REAR * 0.33, _BODY, partial(_stop_pads, STEPS, "r", "vehicle.toml")),
    Check("stop_wrong_file_f", "front pads of Section IV where the file says 0.5", "1",
          0.4, 0.4 * _FRONT, _STUDY, partial(_stop_pads, _STOP, "f", _WRONG)),
    Check("stop_wrong_file_r", "rear pads of Section IV where the file says 0.6", "1",
          0.4, 0.4 * _REAR, _STUDY, partial(_stop_pads, _STOP, "r", _WRONG)),
    Check("stop_torque", "rms error of the front brake torque of hold1, relative", "1", 0.0, _FRONT,
          _TORQUES, _stop_torque),
    Check("stop_interval", "share of samples with the true front pads outside the 95 % interval",
          "1", 0.0, 0.05, _BODY, _outside),
    Check("verdict", "failed of two results that must fail", "results", 2, _COUNT,
          "pads of 0.30 against a limit of 0.35 and more; a log that the table was fitted on",
          _failed),
    Check("export_dcm", "numbers of f2 that differ in the DCM file", "numbers", 0, _COUNT,
          "the table itself, its file read by a search for its lines WERT", _changed),
    Check("damaged_tables", "refused of a version, a cut and an edited export that were damaged",
          "files", 3, _COUNT, "each file was changed by this check", _damaged),
    Check("drag_named", "1 if aerodynamic drag, and it alone, is named", "1", 1, _COUNT,
          _ANSWER.format(HIDDEN), _named),
    Check("drag_size", "drag area that was hidden", "m^2", DRAG, 0.1 * DRAG,
          _ANSWER.format(HIDDEN), _drag),
    Check("no_cause", "1 if nothing is named where nothing is hidden", "1", 1, _COUNT,
          _ANSWER.format(NOTHING), lambda m: float(m.diagnosis(NOTHING).verdict == "no_gap")),
)  # fmt: skip
"""In the order of the work."""
