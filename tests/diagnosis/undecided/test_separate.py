"""The test that is proposed tells two explanations apart, and one that is not does so less.

Both are driven by `calib.model.simulate`, which integrates the motion and shares no step with
the prediction that chose the test.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.explanation.explanation import Explanation, objective
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.own import OWN
from calib.diagnosis.explanation.predict import ObservedRun, run_of
from calib.diagnosis.replays.hold_outs import model_of
from calib.diagnosis.replays.replayed import without_form
from calib.diagnosis.undecided.confusion import confusion_of
from calib.diagnosis.undecided.separate import best_drives, manoeuvres, own_of
from calib.model.simulate import simulate
from tests.support.explained import asked_of, fitted
from tests.support.hidden.cases import draw

NAMES = ("aerodynamic_drag", "rolling_resistance")


@pytest.fixture(scope="module")
def rivals():
    """Drag hidden, seen on stops alone: rolling resistance explains it nearly as well."""
    steps = ("step_high", "step_low")
    problem = asked_of(draw("single", 41, ("aerodynamic_drag",), severity=1, only=steps))
    return [fitted(problem, (name,)) for name in NAMES]


def squares(at: Explanation) -> float:
    """Sum of squares that an explanation leaves."""
    return sum(float(r @ r) for r in at.innovations)


def refitted(rivals: list[Explanation], run: ObservedRun) -> float:
    """How much worse the second model explains logs and a drive that the first one made [sigma].

    Both are fitted anew to logs and drive together; priors count.
    """
    made = without_form(rivals[0])
    model = model_of(made.problem.vehicle, made.base, made.effects)
    driven = simulate(model, run.time, run.p_mc, float(run.v[0]))
    if run.temperature_f is not None:
        n = driven.time.size
        heat = {"T_disc_f": run.temperature_f[:n], "T_disc_r": run.temperature_r[:n]}
        driven = replace(driven, channels=driven.channels | heat)
    more = replace(made.problem, runs=(*made.problem.runs, run_of(driven)))
    found = []
    for at in rivals:
        own = np.vstack([at.state.own, np.zeros((1, len(OWN)))])
        anew = fit(more, at.hypothesis, replace(at.state, own=own))
        found.append(objective(anew))
    return float(np.sqrt(found[1] - found[0]))


def test_the_test_that_is_proposed_separates_most(rivals):
    one, other = rivals
    ((name, sigma),) = best_drives(one, [own_of(other)])
    shown = {n: refitted(rivals, run) for n, run in manoeuvres(one)}
    assert "coast" in name
    assert sigma > 10.0
    assert shown[name] > 0.8 * max(shown.values())
    assert shown[name] > 1.5 * shown["light stop at 8 bar from 60 km/h"]


def test_the_confusion_set_has_each_pair_with_its_drive(rivals):
    drag, rolling = rivals
    assert confusion_of(drag, []) is None
    found = confusion_of(drag, [rolling])
    assert [e.names for e in found.explanations] == [(name,) for name in NAMES]
    assert found.explanations[0].innovation == drag.reduced
    (pair,) = found.pairs
    assert found.pair(0, 1) is found.pair(1, 0) is pair
    assert "coast" in pair.drive
    assert 0.0 < pair.apart < pair.sigma
    # and no farther than their misfits: a triangle with the measurement
    assert pair.apart <= np.sqrt(squares(drag)) + np.sqrt(squares(rolling))
