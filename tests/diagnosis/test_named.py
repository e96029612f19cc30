"""The proposed drive separates rivals, and another drive separates them less.

Drives are simulated by `calib.model.simulate`, which integrates the motion and shares no step with
the prediction that chose them.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.explanation.fit import Fit
from calib.diagnosis.explanation.gauss_newton import fit_logs
from calib.diagnosis.explanation.predict import ObservedRun, run_of
from calib.diagnosis.explanation.unknowns import RANDOM_EFFECTS
from calib.diagnosis.named import best_drive, manoeuvres
from calib.diagnosis.replays import model_of, without_discrepancy
from calib.model.simulate import simulate
from tests.support.explained import fitted, problem_of_case
from tests.support.hidden.cases import draw

NAMES = ("aerodynamic_drag", "rolling_resistance")


@pytest.fixture(scope="module")
def rivals():
    """Drag hidden, seen on stops alone: rolling resistance explains it nearly as well."""
    steps = ("step_high", "step_low")
    problem = problem_of_case(draw("single", 41, ("aerodynamic_drag",), severity=1, only=steps))
    return [fitted(problem, (name,)) for name in NAMES]


def refitted(rivals: list[Fit], fit_made: Fit, run: ObservedRun) -> float:
    """By how much the second rival explains logs and a drive worse than the first [sigma].

    The drive is a simulation by ``fit_made``; both rivals are fitted again to logs and drive.
    """
    model = model_of(fit_made.problem.vehicle, fit_made.base, fit_made.effects)
    driven = simulate(model, run.time, run.p_mc, float(run.v[0]))
    if run.temperature_f is not None:
        n = driven.time.size
        heat = {"T_disc_f": run.temperature_f[:n], "T_disc_r": run.temperature_r[:n]}
        driven = replace(driven, channels=driven.channels | heat)
    more = replace(fit_made.problem, runs=(*fit_made.problem.runs, run_of(driven)))
    squares = []
    for rival in rivals:
        random_effects = np.vstack([rival.state.random_effects, np.zeros(len(RANDOM_EFFECTS))])
        state = replace(rival.state, random_effects=random_effects)
        squares.append(fit_logs(more, rival.hypothesis, state).squares)
    return float(np.sqrt(squares[1] - squares[0]))


def test_the_proposed_drive_separates_most(rivals):
    first, second = rivals
    name, sigma = best_drive(first, second)
    assert "coast" in name
    assert sigma > 10.0
    fit_made, light = without_discrepancy(first), "light stop at 8 bar from 60 km/h"
    runs = {run.source: run for run in manoeuvres(first)}
    distance = {source: refitted(rivals, fit_made, runs[source]) for source in (name, light)}
    assert distance[name] > 1.5 * distance[light]
