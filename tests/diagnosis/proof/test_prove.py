"""The proof on hold-outs: what makes them worse is not named, and what is left is told."""

import numpy as np
import pytest

from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.explanation.ranges import at_bound
from calib.diagnosis.proof.hold_outs import hold_outs_of
from calib.diagnosis.proof.prove import better, prove, remains
from calib.diagnosis.search.decide import Decision
from calib.diagnosis.search.search import added
from tests.support.explained import based
from tests.support.hidden.cases import draw
from tests.support.reference_car import CAR, IDEAL, noisy, ramp, stop


def test_an_effect_that_makes_the_hold_outs_worse_is_withdrawn():
    """The hold-outs are of the car without drag: the named drag would add a gap to them."""
    calibration = [noisy(ramp(IDEAL), 1), noisy(stop(IDEAL), 2)]
    problem = problem_of(CAR, [run_of(log) for log in calibration])
    base = fit(problem, (), np.zeros(BASE))
    wrong = fit(problem, ("aerodynamic_drag",), np.concatenate([base.x, [1.0, 0.0]]), steps=1)
    assert wrong.effects.parameters["aerodynamic_drag"]["drag_area"] > 0.2
    held = hold_outs_of(base, [noisy(stop(IDEAL, pressure=15e5), 3)])
    proved = prove(held, Decision("named", base, wrong, ()))
    assert (proved.decision.verdict, proved.rest) == ("no_gap", False)  # nothing is hidden
    (withdrawn,) = proved.withdrawn
    assert withdrawn.names == ("aerodynamic_drag",)
    assert withdrawn.closed < 0.0
    kept = prove(held, Decision("no_gap", base, base, ()))
    assert (kept.decision.verdict, kept.rest) == ("no_gap", False)


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        (393.0, 396.0, False),
        (393.0, 390.0, False),
        (20.0, 1.0, True),
        (0.5, 0.6, True),
        (0.5, 1.2, False),
    ],
)
def test_replays_must_become_better_or_stay_at_the_noise(before, after, expected):
    assert better(before, after) is expected


@pytest.mark.slow
def test_no_effect_is_named_for_a_better_fit_of_those_before_it():
    """A motor and a delay, not fitted to the end: a ripple explains what that leaves."""
    base = based(case := draw("double", 1360008))
    motor = np.zeros(base.problem.parameters_of("regenerative_torque"))
    motor[0] = 1.0
    names = ("hydraulic_delay", "regenerative_torque")
    beside = fit(base.problem, names, np.concatenate([base.x, [1.0], motor]), steps=4)
    proved = prove(hold_outs_of(base, list(case.holdout)), Decision("named", base, beside, ()))
    assert proved.decision.best.names == beside.names
    assert proved.steps[-1].names == beside.names
    assert proved.steps[-1].innovation < beside.reduced - 0.05
    assert not proved.rest


def test_a_second_effect_is_asked_for_where_nothing_significant_is_left():
    """A lag of a_x beside a delay that explains three hundred times as much."""
    base = based(case := draw("double", 1330013))
    assert set(case.effects) == {"hydraulic_delay", "accelerometer_lag"}
    first = added(base, "hydraulic_delay")
    held = hold_outs_of(base, list(case.holdout[:2]))
    assert not remains(first, held.left(first, held.replayed(first)))
    proved = prove(held, Decision("named", base, first, ()))
    assert proved.decision.best.names == ("hydraulic_delay", "accelerometer_lag")
    assert (proved.decision.verdict, proved.rest) == ("named", False)


@pytest.mark.slow
def test_an_effect_that_ends_at_its_bound_is_exchanged_for_a_simpler_one():
    """A lag and a delay beside a motor, first taken for an oscillation without overshoot."""
    hidden = ("hydraulic_lag", "hydraulic_delay", "regenerative_torque")
    oscillating = base = based(case := draw("triple", 1450000, names=hidden))
    for name in ("hydraulic_oscillation", "regenerative_torque", "hydraulic_delay"):
        oscillating = added(oscillating, name)
    assert "hydraulic_oscillation" in at_bound(oscillating)
    held = hold_outs_of(base, list(case.holdout[:2]))
    proved = prove(held, Decision("named", base, oscillating, ()))
    assert set(proved.decision.best.names) == set(hidden)
    assert proved.decision.best.reduced < oscillating.reduced
