"""What the diagnosis makes of a case of the hidden plant: its problem, its base, its answer."""

from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.fit import fit

from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, problem_of
from tests.support.hidden.cases import HiddenCase


def asked(case: HiddenCase) -> Problem:
    """The problem of the calibration logs."""
    return problem_of(case.vehicle, [run_of(log) for log in case.calibration])


def based(case: HiddenCase) -> Candidate:
    """The vehicle re-identified on the calibration logs, without effects."""
    return fit(problem := asked(case), (), problem.start)


def diagnosed(case: HiddenCase) -> Diagnosis:
    """The whole diagnosis."""
    return diagnose(case.vehicle, list(case.calibration), list(case.holdout))
