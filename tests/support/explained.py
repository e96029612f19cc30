"""What the diagnosis makes of a case of the hidden plant: problem, base, search, answer."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.car.vehicle import Vehicle
from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.diagnosis import Diagnosis
from calib.diagnosis.explanation.fit import Fit
from calib.diagnosis.explanation.gauss_newton import fit_logs
from calib.diagnosis.explanation.hypothesis import Hypothesis, elements_of, start_of
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, problem_of
from calib.diagnosis.search import Search, run_search
from calib.diagnosis.terms import ranked_terms, with_terms
from calib.diagnosis.verdict import Unexplained, plainest, unexplained_of
from calib.logs.log import Log
from tests.support.hidden.cases import HiddenCase


def problem_of_logs(vehicle: Vehicle, logs: Sequence[Log]) -> Problem:
    """The problem of some logs."""
    return problem_of(vehicle, [run_of(log) for log in logs])


def problem_of_case(case: HiddenCase) -> Problem:
    """The problem of the calibration logs."""
    return problem_of_logs(case.vehicle, case.calibration)


def fitted(problem: Problem, names: tuple[str, ...] = (), groups: Sequence[str] = ()) -> Fit:
    """Effects and groups fitted from nothing; strengths begin with one spread."""
    start, hypothesis = start_of(problem), Hypothesis(names, frozenset(groups))
    known_effects = problem.vehicle.effects
    more = [np.eye(len(elements_of(known_effects, name)))[0] for name in names]
    state = replace(start, x=np.concatenate([start.x, *more]))
    return fit_logs(problem, hypothesis, state)


def based(case: HiddenCase) -> Fit:
    """The vehicle re-identified on the calibration logs, without effects."""
    return fitted(problem_of_case(case))


def search_in(vehicle: Vehicle, logs: Sequence[Log], holdouts: Sequence[Log]) -> Search:
    """The search in some logs, judged by others."""
    return run_search(problem_of_logs(vehicle, logs), holdouts)


def diagnosed(case: HiddenCase) -> Diagnosis:
    """The whole diagnosis."""
    return diagnose(case.vehicle, list(case.calibration), list(case.holdout))


def left_in(case: HiddenCase) -> Unexplained:
    """What the calibration logs have beyond the vehicle without effects."""
    base = based(case)
    return unexplained_of(base, plainest(base, with_terms(base, ranked_terms(base))), 0.0)
