"""The prediction against the plant of the tests: what it says, a car does."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.tyre import MagicFormula
from calib.diagnosis.explanation.predict import Base, predict, run_of
from tests.support.plant import Plant, as_log, drive, magic
from tests.support.reference_car import CAR as SEDAN
from tests.support.reference_car import without

BASE = Base(SEDAN.front.pad_friction, SEDAN.rear.pad_friction, MagicFormula(25.0, 0.95))


def pressure(t: float) -> float:
    return 25e5 * min(max((t - 1.0) / 0.3, 0.0), 1.0)


@pytest.fixture(scope="module")
def run():
    plant = Plant(SEDAN, tyre=magic(25.0, 0.95))
    return run_of(as_log(drive(plant, pressure, 28.0, duration=6.0)))


def test_a_plant_with_the_same_physics_is_predicted(run):
    prediction = predict(SEDAN, BASE, Effects(), run)
    inside = slice(200, -10)
    assert prediction.a_x[inside] == pytest.approx(run.a_x[inside], abs=2e-3)
    # half of what a speed's noise is, after 16 m/s of braking
    gained = run.v_read - run.v_read[0]
    assert prediction.speed_gain[inside] == pytest.approx(gained[inside], abs=1e-2)
    assert prediction.omega[:, inside] == pytest.approx(run.omega[:, inside], abs=2e-2)


def test_wheels_swing_on_their_tyres_when_a_slow_car_releases_its_brakes():
    """0.4 m of relaxation at 5 m/s: the wheels swing for some tenths of a second at 25 Hz."""

    def released(t: float) -> float:
        return pressure(t) - 25e5 * min(max((t - 4.0) / 0.05, 0.0), 1.0)

    plant = Plant(SEDAN, tyre=magic(25.0, 0.95), relaxation=0.4)
    run = run_of(as_log(drive(plant, released, 14.5, duration=5.0)))
    base = replace(BASE, tyre=replace(BASE.tyre, relaxation=0.4))
    prediction = predict(SEDAN, base, Effects(), run)
    free = (run.time > 4.06) & (run.time < 4.4)
    assert 3.0 < np.min(run.v_read[free]) < 6.0
    swing = run.omega[0, free] - run.v_read[free] / SEDAN.front.rolling_radius
    remaining = (run.omega - prediction.omega)[0, free]
    assert np.std(swing) > 0.1
    assert np.std(remaining) < 0.6 * np.std(swing)  # the brakes end within a step of the grid


def test_a_logged_motor_is_predicted_and_one_that_is_not_is_missed():
    plant = Plant(SEDAN, tyre=magic(25.0, 0.95), motor=lambda t: (-80.0, -160.0 * min(t, 1.0)))
    log = as_log(drive(plant, pressure, 28.0, duration=6.0))
    run, inside = run_of(log), slice(200, -10)
    prediction = predict(SEDAN, BASE, Effects(), run)
    assert prediction.a_x[inside] == pytest.approx(run.a_x[inside], abs=2e-3)
    assert prediction.omega[:, inside] == pytest.approx(run.omega[:, inside], abs=2e-2)
    blind = predict(SEDAN, BASE, Effects(), run_of(without(log, "T_drive_f", "T_drive_r")))
    # 240 N m at 0.3 m on 1744 kg
    assert np.mean((blind.a_x - run.a_x)[inside]) == pytest.approx(0.44, abs=0.03)


@pytest.mark.parametrize("place", ["body", "brakes"])
def test_a_term_over_the_deceleration_does_not_predict_noise_from_itself(run, place):
    """One sensor's noise more on a_x must not show in what is predicted."""
    noisy = replace(run, z=run.z + np.random.default_rng(3).normal(0.0, 0.05, run.z.size) / G)
    values = (0.0, -0.1) if place == "body" else (0.0, -0.4)
    term = EmpiricalTerm(place, "deceleration", (0.0, 0.4), values)
    prediction, clean = (predict(SEDAN, BASE, Effects(terms=(term,)), r).a_x for r in (noisy, run))
    assert np.std(prediction - clean) < 0.02 * 0.05


def test_a_known_lag_of_the_wheels_serves_only_behind_the_same_tyres(run):
    lag = predict(SEDAN, BASE, Effects(), run).lag
    for base in (BASE, replace(BASE, tyre=MagicFormula(18.0, 0.95))):
        prediction = predict(SEDAN, base, Effects(), run, lag)
        assert np.array_equal(prediction.omega, predict(SEDAN, base, Effects(), run).omega)
