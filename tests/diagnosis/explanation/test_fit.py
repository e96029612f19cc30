"""The columns of a fit against differences of predictions, and fits against plants."""

from dataclasses import replace

import numpy as np
import pytest

import calib
from calib.base.arrays import Array
from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.fit import Fit, innovations, linearised
from calib.diagnosis.explanation.hypothesis import Hypothesis, State, base_and_effects, start_of
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.explanation.unknowns import BASE_NAMES, LOW, RANDOM_EFFECTS
from calib.diagnosis.replays import without_discrepancy
from calib.model.sensor_noise import add_noise
from tests.support.effect_runs import SEDAN
from tests.support.explained import fitted, problem_of_case, problem_of_logs
from tests.support.hidden.cases import HiddenCase, draw
from tests.support.plant import Plant, magic
from tests.support.reference_car import CAR, noisy, ramp, stop

DRAG, FADE = "aerodynamic_drag", "pad_thermal_fade"
STEPS = dict(zip(RANDOM_EFFECTS, (1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-2, 5.0, 5.0), strict=True))
"""Half the differences by which random effects are changed, in their units."""


@pytest.fixture(scope="module")
def fading() -> Fit:
    """A ramp and a stop without temperatures, of pads that fade, away from where a fit begins."""
    time = np.arange(0.0, 9.0, 0.005)
    effects = Effects({FADE: {"fade_slope": 0.0012, "fade_onset": 150.0}})
    model = replace(calib.default_model(SEDAN), effects=effects)
    logs = []
    for name, p in {"ramp": 4e5 * (time - 1.5), "stop": 60e5 * (time - 1.5)}.items():
        pressed = np.clip(p, 0.0, 28e5)
        log = calib.simulate(model, time, pressed, 35.0, start_heat=(200.0, 150.0), name=name)
        logs.append(add_noise(log, len(logs)))
    problem, hypothesis = problem_of_logs(SEDAN, logs), Hypothesis((FADE,))
    start = start_of(problem)
    u = np.zeros_like(start.random_effects)
    u[:, -2:] = 150.0, -40.0
    x = np.concatenate([start.x + 0.02, [2.0, 0.0]])
    state = State(x, 0.02 * np.cos(np.arange(start.discrepancy.size)), u)
    return linearised(problem, hypothesis, state)


def same(result: Array, expected: Array, within: float) -> bool:
    """Whether two columns are the same within a share of their length."""
    return bool(np.linalg.norm(result - expected) <= within * np.linalg.norm(expected))


@pytest.mark.parametrize("name", RANDOM_EFFECTS)
def test_columns_of_random_effects_are_differences_of_innovations(fading, name):
    base, effects = base_and_effects(fading.problem, fading.hypothesis, fading.state)
    k, h = RANDOM_EFFECTS.index(name), STEPS[name]
    for i, run in enumerate(fading.problem.runs):
        ends = []
        for step in (h, -h):
            u = fading.state.random_effects[i].copy()
            u[k] += step
            ends.append(innovations(fading.problem, base, effects, run.with_random_effects(u)))
        assert same(fading.random_columns(i)[k], (ends[0] - ends[1]) / (2.0 * h), 0.005)


def test_columns_of_the_discrepancy_are_differences_of_predictions(fading):
    columns = [J[fading.state.x.size :] for J in fading.columns]
    for k in range(fading.state.discrepancy.size):
        ends = []
        for step in (1e-3, -1e-3):
            discrepancy = fading.state.discrepancy.copy()
            discrepancy[k] += step
            ends.append(fading.at_state(replace(fading.state, discrepancy=discrepancy)).innovations)
        for result, above, below in zip(columns, *ends, strict=True):
            assert same(result[k], (above - below) / 2e-3, 1e-6)
    reached = [np.any(result, axis=1).sum() for result in columns]
    assert min(reached) >= 6  # knots of both axles up to half a g


@pytest.mark.parametrize("name", BASE_NAMES)
def test_a_base_parameter_acts_at_its_lower_bound(fading, name):
    """A fit that comes to a bound where a parameter does not act would stay there."""
    k = BASE_NAMES.index(name)
    x = fading.state.x.copy()
    x[k] = LOW[k]
    result = linearised(fading.problem, fading.hypothesis, replace(fading.state, x=x))
    assert any(np.any(J[k]) for J in result.columns)


def hard(vehicle: Vehicle, plant: Plant) -> Problem:
    logs = (ramp(plant), stop(plant, 15e5, "light"), stop(plant, 70e5, "hard"))
    return problem_of_logs(vehicle, [noisy(log, seed) for seed, log in enumerate(logs, 1)])


def test_a_hard_stop_shows_a_peak_above_the_usual_one():
    """From the usual 0.95 alone a fit may end at 0.90 and 0.98, with 3.5 of mean square."""
    peak = 1.15
    front_biased = replace(CAR, rear=replace(CAR.rear, piston_area=0.6 * CAR.rear.piston_area))
    result = fitted(hard(front_biased, Plant(front_biased, tyre=magic(18.0, peak, 1.55))))
    assert result.mean_square < 1.15
    assert result.base.tyre.peak == pytest.approx(peak, rel=0.06)
    model = without_discrepancy(result)  # as it is simulated
    assert model.mean_square < 1.15


@pytest.fixture(scope="module")
def drag() -> HiddenCase:
    """Its drag acts at the height of the centre of gravity: it moves no load."""
    return draw("single", 10, (DRAG,), severity=1, only=("coast", "ramp", "step_high"))


def test_the_load_that_a_hidden_drag_moves_is_one_of_its_parameters(drag):
    result = fitted(problem_of_case(drag), (DRAG,)).effects.parameters[DRAG]
    assert result["load_share"] == pytest.approx(0.0, abs=0.2)
    assert result["drag_area"] == pytest.approx(drag.hidden.drag_area, rel=0.03)
