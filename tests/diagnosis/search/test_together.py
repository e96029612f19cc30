"""Two effects that another one imitates as long as one of them is missing."""

import numpy as np
import pytest

from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.search.search import refine
from calib.diagnosis.search.together import pairs, together
from tests.support.hidden.cases import draw


@pytest.fixture(scope="module")
def base():
    """A car with more drag on a road that slopes: a bias of the accelerometer imitates both."""
    names = ("aerodynamic_drag", "road_grade")
    case = draw("double", 4, names=names, severity=2)
    kept = ("coast", "coast_slow", "ramp_fast")
    problem = problem_of(case.vehicle, [run_of(x) for x in case.calibration if x.name in kept])
    return fit(problem, (), np.zeros(BASE))


def test_the_true_pair_is_first_and_keeps_its_promise(base):
    best = pairs(base)[0]
    assert set(best.names) == {"aerodynamic_drag", "road_grade"}
    (fitted,) = together(base, 1, 0.0)
    assert fitted.names == best.names
    assert base.chi2 - fitted.chi2 == pytest.approx(best.gain, rel=0.1)


def test_a_pair_gains_more_than_either_of_its_effects(base):
    best = pairs(base)[0]
    alone = {c.names[0]: base.chi2 - c.chi2 for c in refine(base, 4)}
    assert best.gain > max(alone.get(name, 0.0) for name in best.names)
