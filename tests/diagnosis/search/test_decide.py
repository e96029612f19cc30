"""Which of two explanations of as many parameters is taken."""

from calib.diagnosis.diagnose import by_log
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.explanation.ranges import at_bound
from calib.diagnosis.search.decide import decide, explains
from calib.diagnosis.search.search import added
from tests.support.hidden.cases import draw


def test_a_lag_with_a_delay_is_no_lag_at_the_end_of_its_range():
    case = draw("double", 7, names=("hydraulic_lag", "hydraulic_delay"))
    problem = problem_of(case.vehicle, [run_of(log) for log in case.calibration[:3]])
    base = fit(problem, (), problem.start)
    assert at_bound(added(base, "hydraulic_lag"))
    decision = decide(base)
    assert decision.verdict in ("named", "ambiguous")
    assert set(decision.best.names) == {"hydraulic_delay", "hydraulic_lag"}


def test_no_groups_are_looked_for_where_a_faint_second_effect_explains_all():
    """A rear valve beside radii that differ by 0.3 %, which explain forty times as much."""
    case = draw("double", 1460006)
    problem = problem_of(case.vehicle, [run_of(log) for log in case.calibration])
    decision = decide(fit(problem, (), problem.start))
    assert decision.best.names == ("rolling_radius_mismatch",)
    assert not explains(decision)
    assert by_log(decision) is decision
