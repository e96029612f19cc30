"""The plant of hidden effects: it shares nothing with the program, and obeys closed forms."""

import ast
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.support.hidden.cases import CARS
from tests.support.hidden.hydraulics import lines
from tests.support.hidden.manoeuvres import Manoeuvre, manoeuvre
from tests.support.hidden.plant import AMBIENT, COOLING, Car, Start, drive
from tests.support.hidden.settings import Hidden
from tests.support.plant import magic

HERE = Path(__file__).parent
TYRE = magic(26.0, 1.0)


@cache
def told(name: str) -> Manoeuvre:
    return manoeuvre(name, CARS[1], np.random.default_rng(3))


def driven(hidden: Hidden = Hidden(), name: str = "release", **start) -> dict[str, np.ndarray]:  # noqa: B008
    m = told(name)
    first = replace(Start(m.v0, m.temperature), **start)
    return drive(Car(CARS[1], TYRE, hidden=hidden), lines(hidden, m.pressure), first)


@cache
def bare(name: str) -> dict[str, np.ndarray]:
    return driven(name=name)


def test_the_plant_shares_nothing_with_the_simulation_and_the_catalogue():
    files = [*HERE.glob("*.py"), HERE.parent / "plant.py", HERE.parents[1] / "studies/ensemble.py"]
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom):
                assert node.module is not None
                assert not node.module.startswith(
                    (
                        "calib.car.effects",
                        "calib.model.simulate",
                        "calib.diagnosis",
                        "calib.car.forces",
                    )
                ), f"{file.name}: {node.module}"


def test_a_bare_car_coasts_for_ever():
    run = bare("coast")
    assert np.ptp(run["v"]) < 1e-6
    assert np.abs(run["a_x"]).max() < 1e-6
    assert run["omega_rl"] * CARS[1].rear.rolling_radius == pytest.approx(run["v"], rel=1e-6)


def test_a_bare_car_brakes_as_newton_has_it():
    run, car = bare("step_low"), CARS[1]
    i = run["time"].searchsorted(3.0)
    torque = [a.torque_gain * a.pad_friction * run["p_mc"][i] for a in (car.front, car.rear)]
    spin = np.gradient(run["omega_fl"], run["time"])[i], np.gradient(run["omega_rl"], 0.005)[i]
    axles = (car.front, car.rear)
    force = sum(
        2.0 * (t + a.wheel_inertia * w) / a.rolling_radius
        for t, a, w in zip(torque, axles, spin, strict=True)
    )
    assert run["a_x"][i] == pytest.approx(-force / car.mass, rel=1e-4)


def test_discs_warm_with_what_the_car_loses():
    run, car = bare("step_high"), CARS[1]
    lost = 0.5 * car.mass * (run["v"][0] ** 2 - run["v"][-1] ** 2)
    cooled = [COOLING[k] * np.trapezoid(run[f"T_disc_{s}"] - AMBIENT, run["time"])
              for k, s in enumerate("fr")]  # fmt: skip
    rise = [run[f"T_disc_{s}"][-1] - run[f"T_disc_{s}"][0] for s in "fr"]
    heat = 13.4e3 * (rise[0] + cooled[0]) + 8.1e3 * (rise[1] + cooled[1])
    # Wheels store 2 to 3 % of it, slip takes 1 to 2 %.
    assert heat == pytest.approx(lost, rel=0.03)
