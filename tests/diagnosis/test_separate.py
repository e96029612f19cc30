"""The test that is proposed tells two explanations apart, and one that is not does so less.

Both are driven by `calib.simulation.simulate`, which integrates the motion and shares no step with
the prediction that chose the test.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.candidate import BASE, fit, problem_of
from calib.diagnosis.confusion import confusion_of
from calib.diagnosis.hold_outs import model_of
from calib.diagnosis.predict import run_of
from calib.diagnosis.search import unresolved
from calib.physics.effects.catalogue import CATALOGUE
from calib.diagnosis.separate import distance, manoeuvres, separate_by
from calib.simulation.simulate import simulate
from tests.support.hidden.cases import draw


@pytest.fixture(scope="module")
def rivals():
    """Drag hidden, seen on stops alone: rolling resistance explains it nearly as well."""
    case = draw("single", 41, names=("aerodynamic_drag",), severity=1)
    runs = [run_of(log) for log in case.calibration if log.name.startswith("step")]
    problem = problem_of(case.vehicle, runs)
    base = fit(problem, (), np.zeros(BASE))
    start = np.concatenate([base.x, [0.5]])
    pair = [fit(problem, (n,), start) for n in ("aerodynamic_drag", "rolling_resistance")]
    return case.vehicle, problem, pair


def apart(vehicle, pair, run) -> float:
    """Rms of v between the two models, driven open loop through a manoeuvre [m/s]."""
    driven = [
        simulate(replace(model_of(vehicle, c)), run.time, run.p_mc, float(run.v[0])) for c in pair
    ]
    n = min(log.time.size for log in driven)
    return float(np.sqrt(np.mean((driven[0]["v"][:n] - driven[1]["v"][:n]) ** 2)))


def test_the_test_that_is_proposed_separates_most(rivals):
    vehicle, problem, pair = rivals
    said = separate_by(problem, *pair)
    tests = dict(manoeuvres(problem))
    name = next(n for n in tests if said.startswith(n))
    assert "coast" in name
    shown = {n: apart(vehicle, pair, run) for n, run in tests.items()}
    assert shown[name] > 2.0 * shown["light stop at 8 bar from 60 km/h"]
    assert shown[name] > 0.1
    assert distance(problem, *pair, tests[name]) > 10.0


def test_nothing_separates_an_explanation_from_itself(rivals):
    _, problem, (one, _) = rivals
    for _, run in manoeuvres(problem):
        assert distance(problem, one, one, run) == 0.0


def test_the_confusion_set_has_each_pair_with_its_drive(rivals):
    _, problem, (drag, rolling) = rivals
    assert confusion_of(problem, drag, []) is None
    found = confusion_of(problem, drag, [rolling])
    assert [e.names for e in found.explanations] == [("aerodynamic_drag",), ("rolling_resistance",)]
    assert found.explanations[0].innovation == drag.reduced
    (pair,) = found.pairs
    assert found.pair(0, 1) is found.pair(1, 0) is pair
    assert "coast" in pair.drive
    # both were fitted to these logs, so they are nearer to each other there than in the drive
    assert 0.0 < pair.apart < 0.5 * pair.sigma
    # and no farther than their misfits: a triangle with the measurement
    assert pair.apart <= np.sqrt(drag.chi2) + np.sqrt(rolling.chi2)


def test_a_cold_car_cannot_show_fade_and_coasting_shows_drag():
    case = draw("none", 42)
    runs = [run_of(log) for log in case.calibration if log.name in ("coast", "step_low")]
    problem = problem_of(case.vehicle, runs)
    silent = unresolved(problem, fit(problem, (), np.zeros(BASE)), dict.fromkeys(CATALOGUE, 64.0))
    assert "pad_thermal_fade" in silent
    assert "mass_error" in silent
    assert "aerodynamic_drag" not in silent
    assert "accelerometer_bias" not in silent
