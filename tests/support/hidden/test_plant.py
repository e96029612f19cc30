"""The plants of the tests share nothing with the program, and brake as Newton has it."""

import ast
from pathlib import Path

import numpy as np
import pytest

from tests.support.hidden.cases import CARS
from tests.support.hidden.hydraulics import lines
from tests.support.hidden.manoeuvres import manoeuvre
from tests.support.hidden.plant import Car, Start, drive
from tests.support.hidden.settings import Hidden
from tests.support.plant import magic

HERE = Path(__file__).parent
OURS = ("calib.car.effects", "calib.car.forces", "calib.diagnosis", "calib.model.simulate")


def test_the_plants_share_nothing_with_the_simulation_and_the_catalogue():
    others = (HERE.parent / "plant.py", HERE.parents[1] / "studies" / "plant_r.py")
    for file in [*HERE.glob("*.py"), *others]:
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom):
                assert not (node.module or "").startswith(OURS), f"{file.name}: {node.module}"


def test_a_bare_car_brakes_as_newton_has_it():
    car, pedal = CARS[1], manoeuvre("step_low", CARS[1], np.random.default_rng(3))
    start = Start(pedal.v0, pedal.temperature)
    run = drive(Car(car, magic(26.0, 1.0)), lines(Hidden(), pedal.pressure), start)
    i = run["time"].searchsorted(3.0)
    force = 0.0
    for axle, wheel in ((car.front, "omega_fl"), (car.rear, "omega_rl")):
        torque = axle.torque_gain * axle.pad_friction * run["p_mc"][i]
        spin = np.gradient(run[wheel], run["time"])[i]
        force += 2.0 * (torque + axle.wheel_inertia * spin) / axle.rolling_radius
    assert run["a_x"][i] == pytest.approx(-force / car.mass, rel=1e-4)
