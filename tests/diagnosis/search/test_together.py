"""Two effects that another one imitates as long as one of them is missing."""

import pytest

from calib.diagnosis.search.search import refine
from calib.diagnosis.search.together import pairs, together
from tests.support.explained import based
from tests.support.hidden.cases import draw


@pytest.fixture(scope="module")
def base():
    """A car with more drag on a road that slopes: a bias of the accelerometer imitates both."""
    names = ("aerodynamic_drag", "road_grade")
    return based(draw("double", 4, names, severity=2, only=("coast", "coast_slow", "ramp_fast")))


def test_the_true_pair_is_first_and_keeps_its_promise(base):
    best = pairs(base)[0]
    assert set(best.names) == {"aerodynamic_drag", "road_grade"}
    (fitted,) = together(base, 1, 0.0)
    assert fitted.names == best.names
    assert base.chi2 - fitted.chi2 == pytest.approx(best.gain, rel=0.1)
    alone = {c.names[0]: base.chi2 - c.chi2 for c in refine(base, 4)}
    assert best.gain > max(alone.get(name, 0.0) for name in best.names)
