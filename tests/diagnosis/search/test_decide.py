"""Which of two explanations of as many parameters is taken."""

import pytest

from calib.diagnosis.diagnose import by_log
from calib.diagnosis.explanation.ranges import at_bound
from calib.diagnosis.search.decide import decide, explains
from calib.diagnosis.search.search import added
from tests.support.explained import based
from tests.support.hidden.cases import draw


def test_a_lag_with_a_delay_is_no_lag_at_the_end_of_its_range():
    names = ("hydraulic_lag", "hydraulic_delay")
    base = based(draw("double", 7, names, only=("coast", "coast_slow", "hot")))
    assert at_bound(added(base, "hydraulic_lag"))
    decision = decide(base)
    assert decision.verdict in ("named", "ambiguous")
    assert set(decision.best.names) == {"hydraulic_delay", "hydraulic_lag"}


@pytest.mark.slow
def test_no_groups_are_looked_for_where_a_faint_second_effect_explains_all():
    """A rear valve beside radii that differ by 0.3 %, which explain forty times as much."""
    decision = decide(based(draw("double", 1460006)))
    assert decision.best.names == ("rolling_radius_mismatch",)
    assert not explains(decision)
    assert by_log(decision) is decision
