"""Effects and the place of what is left are found alike in one process and in several."""

from dataclasses import replace

import pytest

from calib.base.processes import side_by_side
from calib.diagnosis.explanation.fit import fit, fit_base
from calib.diagnosis.proof.unexplained import locate
from calib.diagnosis.search.search import refine
from tests.support.explained import asked, based
from tests.support.hidden.cases import draw


@pytest.fixture(scope="module")
def base():
    """A ramp and a coast of a car with a lag."""
    few = ("coast", "ramp_fast")
    return based(draw("single", 9, names=("hydraulic_lag",), severity=0, only=few))


def test_two_processes_find_and_place_what_one_does(base):
    alone, place = refine(base, 3), locate(base)
    told = []
    with side_by_side(2, "calib.diagnosis.search.search") as mapped:
        heard = replace(base.problem, mapped=mapped, tell=lambda *stage: told.append(stage))
        together = refine(replace(base, problem=heard), 3)
        placed = locate(replace(base, problem=heard))
    assert alone[0].names == ("hydraulic_lag",)
    assert [c.names for c in together] == [c.names for c in alone]
    for one, other in zip(alone, together, strict=True):
        assert one.x == pytest.approx(other.x, rel=1e-6, abs=1e-9)
        assert one.chi2 == pytest.approx(other.chi2, rel=1e-9)
    assert told
    assert placed.term.place == place.term.place
    assert placed.term.values == pytest.approx(place.term.values, rel=1e-6)
    assert [r[:2] for r in placed.runners_up] == [r[:2] for r in place.runners_up]


def test_what_is_not_fitted_to_its_end_cannot_be_the_best():
    """Fits that go on from there, each to its end, come nowhere near the best."""
    problem = asked(draw("single", 9, names=("hydraulic_lag",)))
    found = refine(fit_base(problem))
    rough = [one for one in found if not one.converged]
    assert rough
    for one in rough:
        assert fit(problem, one.names, one.x).chi2 > found[0].chi2
    assert found[0].chi2 == pytest.approx(fit(problem, found[0].names, found[0].x).chi2, rel=1e-3)


def test_what_cannot_come_near_the_noise_is_not_fitted(base):
    assert refine(base, 3, below=0.5 * base.chi2)[0].names == ("hydraulic_lag",)
    fitted, hopeful = refine(base, 20), refine(base, 20, below=0.0)
    assert hopeful[0].names == fitted[0].names
    assert len(hopeful) < len(fitted)
    assert all(one.reduced < 2.0 * fitted[0].reduced for one in hopeful)
