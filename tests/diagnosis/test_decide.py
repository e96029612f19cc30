"""Which of two explanations of as many parameters is taken."""

from calib.diagnosis.candidate import at_bound, fit, problem_of
from calib.diagnosis.decide import decide
from calib.diagnosis.predict import run_of
from calib.diagnosis.search import added
from tests.support.hidden.cases import draw


def test_a_lag_with_a_delay_is_no_oscillation_at_the_end_of_its_range():
    case = draw("double", 1360018)
    problem = problem_of(case.vehicle, [run_of(log) for log in case.calibration[:3]])
    base = fit(problem, (), problem.start)
    assert at_bound(added(base, "hydraulic_oscillation"))
    decision = decide(base)
    assert decision.verdict == "named"
    assert set(decision.best.names) == {"hydraulic_delay", "hydraulic_lag"}
