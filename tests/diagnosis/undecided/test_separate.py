"""The test that is proposed tells two explanations apart, and one that is not does so less.

Both are driven by `calib.model.simulate`, which integrates the motion and shares no step with
the prediction that chose the test.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.catalogue import CATALOGUE
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.proof.hold_outs import model_of
from calib.diagnosis.search.search import unresolved
from calib.diagnosis.undecided.confusion import confusion_of
from calib.diagnosis.undecided.separate import best_drive, manoeuvres
from calib.model.simulate import simulate
from tests.support.explained import based
from tests.support.hidden.cases import draw


@pytest.fixture(scope="module")
def rivals():
    """Drag hidden, seen on stops alone: rolling resistance explains it nearly as well."""
    steps = ("step_high", "step_low")
    base = based(draw("single", 41, ("aerodynamic_drag",), severity=1, only=steps))
    start = np.concatenate([base.x, [0.5, 0.0]])
    pair = [fit(base.problem, (n,), start) for n in ("aerodynamic_drag", "rolling_resistance")]
    return base.problem.vehicle, base.problem, pair


def refitted(vehicle, problem, pair, run) -> float:
    """How much worse the second model explains logs and a drive that the first one made [sigma].

    Both are fitted anew to logs and drive together.
    """
    one, other = pair
    driven = simulate(model_of(vehicle, one), run.time, run.p_mc, float(run.v[0]))
    if run.temperature_f is not None:
        n = driven.time.size
        heat = {"T_disc_f": run.temperature_f[:n], "T_disc_r": run.temperature_r[:n]}
        driven = replace(driven, channels=driven.channels | heat)
    more = replace(problem, runs=(*problem.runs, run_of(driven)))
    first, second = (fit(more, c.names, c.x) for c in (one, other))
    return float(np.sqrt(second.chi2 - first.chi2))


def test_the_test_that_is_proposed_separates_most(rivals):
    vehicle, problem, pair = rivals
    name, _ = best_drive(problem, *pair)
    tests = dict(manoeuvres(problem))
    assert "coast" in name
    shown = {n: refitted(vehicle, problem, pair, run) for n, run in tests.items()}
    assert shown[name] > 0.8 * max(shown.values())
    assert shown[name] > 1.5 * shown["light stop at 8 bar from 60 km/h"]


def test_the_confusion_set_has_each_pair_with_its_drive(rivals):
    _, problem, (drag, rolling) = rivals
    assert confusion_of(problem, drag, []) is None
    found = confusion_of(problem, drag, [rolling])
    assert [e.names for e in found.explanations] == [("aerodynamic_drag",), ("rolling_resistance",)]
    assert found.explanations[0].innovation == drag.reduced
    (pair,) = found.pairs
    assert found.pair(0, 1) is found.pair(1, 0) is pair
    assert "coast" in pair.drive
    assert 0.0 < pair.apart < pair.sigma
    # and no farther than their misfits: a triangle with the measurement
    assert pair.apart <= np.sqrt(drag.chi2) + np.sqrt(rolling.chi2)


def test_a_cold_car_cannot_show_fade_and_coasting_shows_drag():
    base = based(draw("none", 42, only=("coast", "step_low")))
    silent = unresolved(base, dict.fromkeys(CATALOGUE, 64.0))
    assert "pad_thermal_fade" in silent
    assert "mass_error" in silent
    assert "aerodynamic_drag" not in silent
    assert "accelerometer_bias" not in silent
