"""A fit of the base parameters, and effects that the range of a parameter holds."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.catalogue import CATALOGUE
from calib.car.vehicle import Vehicle
from calib.diagnosis.explanation.candidate import Candidate
from calib.diagnosis.explanation.fit import fit, fit_base
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import Problem, problem_of
from calib.diagnosis.explanation.ranges import pressed
from tests.support.plant import Plant, magic
from tests.support.reference_car import CAR, IDEAL, noisy, ramp, stop


def problem(vehicle: Vehicle, plant: Plant, hard: float) -> Problem:
    logs = (ramp(plant), stop(plant, 15e5, "light"), stop(plant, hard, "hard"))
    return problem_of(vehicle, [run_of(noisy(log, seed)) for seed, log in enumerate(logs, 1)])


@pytest.mark.parametrize("peak", [1.1, 1.15])
def test_a_hard_stop_shows_a_peak_above_the_usual_one(peak):
    """From the usual 0.95 alone the fit ended at 0.90 and 0.98, with 3.5 of mean square."""
    front_biased = replace(CAR, rear=replace(CAR.rear, piston_area=0.6 * CAR.rear.piston_area))
    plant = Plant(front_biased, tyre=magic(18.0, peak, 1.55))
    found = fit_base(problem(front_biased, plant, 70e5))
    assert found.reduced < 1.15
    assert found.base.peak == pytest.approx(peak, rel=0.06)


def mismatch(size: float) -> Candidate:
    """The fit of other radii at the rear, where the plant has them ``size`` larger [1]."""
    car = problem(CAR, replace(IDEAL, radius_scale=(1.0, 1.0 + size)), 30e5)
    start = np.append(fit_base(car).x, 0.0)
    return fit(car, ("rolling_radius_mismatch",), start)


def test_the_range_of_a_card_holds_what_lies_past_it():
    (own,) = CATALOGUE["rolling_radius_mismatch"].card.parameters
    assert pressed(mismatch(1.5 * own.high)) == ("rolling_radius_mismatch",)
    assert pressed(mismatch(0.5 * own.high)) == ()
