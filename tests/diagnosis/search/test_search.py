"""Effects and the place of what is left are found alike in one process and in several."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.processes import side_by_side
from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.fit import fit, fit_base
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.proof.unexplained import locate
from calib.diagnosis.search.search import refine
from tests.support.hidden.cases import draw


@pytest.fixture(scope="module")
def problem():
    """A ramp and a coast of a car with a lag."""
    case = draw("single", 9, names=("hydraulic_lag",), severity=0)
    runs = [run_of(log) for log in case.calibration if log.name in ("coast", "ramp_fast")]
    return problem_of(case.vehicle, runs)


def test_two_processes_find_what_one_finds(problem):
    base = fit(problem, (), np.zeros(BASE))
    alone = refine(base, 3)
    with side_by_side(2, "calib.diagnosis.search.search") as mapped:
        together = refine(replace(base, problem=replace(problem, mapped=mapped)), 3)
    assert alone[0].names == ("hydraulic_lag",)
    assert [c.names for c in together] == [c.names for c in alone]
    for one, other in zip(alone, together, strict=True):
        assert one.x == pytest.approx(other.x, rel=1e-6, abs=1e-9)
        assert one.chi2 == pytest.approx(other.chi2, rel=1e-9)


def test_two_processes_place_what_is_left_as_one_does(problem):
    base = fit(problem, (), np.zeros(BASE))
    alone = locate(base)
    told = []
    with side_by_side(2, "calib.diagnosis.search.search") as mapped:
        heard = replace(problem, mapped=mapped, tell=lambda *stage: told.append(stage))
        together = locate(replace(base, problem=heard))
    assert told
    assert together.term.place == alone.term.place
    assert together.term.values == pytest.approx(alone.term.values, rel=1e-6)
    assert [r[:2] for r in together.runners_up] == [r[:2] for r in alone.runners_up]


def test_what_is_not_fitted_to_its_end_cannot_be_the_best():
    """Fits that go on from there, each to its end, come nowhere near the best."""
    case = draw("single", 9, names=("hydraulic_lag",))
    problem = problem_of(case.vehicle, [run_of(log) for log in case.calibration])
    found = refine(fit_base(problem))
    rough = [one for one in found if not one.converged]
    assert rough
    for one in rough:
        assert fit(problem, one.names, one.x).chi2 > found[0].chi2
    assert found[0].chi2 == pytest.approx(fit(problem, found[0].names, found[0].x).chi2, rel=1e-3)


def test_what_cannot_come_near_the_noise_is_not_fitted(problem):
    base = fit(problem, (), np.zeros(BASE))
    assert refine(base, 3, below=0.5 * base.chi2)[0].names == ("hydraulic_lag",)
    fitted, hopeful = refine(base, 20), refine(base, 20, below=0.0)
    assert hopeful[0].names == fitted[0].names
    assert len(hopeful) < len(fitted)
    assert all(one.reduced < 2.0 * fitted[0].reduced for one in hopeful)
