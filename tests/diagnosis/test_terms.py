"""A term that is hidden in simulated runs is found at its place, over its driver, with its values.

`calib.simulate` integrates the motion and shares no step with the prediction that the fit uses.
"""

from dataclasses import replace

import numpy as np
import pytest

import calib
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.effects.empirical import PLACES
from calib.diagnosis.explanation.fit import Fit
from calib.diagnosis.explanation.hypothesis import Hypothesis, Walk
from calib.diagnosis.terms import ranked_terms, with_terms
from calib.model.sensor_noise import add_noise
from tests.support.effect_runs import SEDAN
from tests.support.explained import fitted, problem_of_logs

TIME = np.arange(0.0, 9.0, 0.005)
RUNS = {
    "ramp": (1.5, 4e5, 30e5, 35.0),
    "stop": (1.5, 60e5, 22e5, 33.0),
    "light": (2.5, 4e6, 9e5, 28.0),
}
"""Begin [s], rise [Pa/s], top [Pa] of the pressure, and speed [m/s]."""


def best_with(term: EmpiricalTerm) -> Fit:
    """The best fit with a term, to simulated runs that hide ``term``."""
    model = replace(calib.default_model(SEDAN), effects=Effects(terms=(term,)))
    logs = []
    for name, (begin, rise, top, speed) in RUNS.items():
        p = np.clip(rise * (TIME - begin), 0.0, top)
        logs.append(add_noise(calib.simulate(model, TIME, p, speed, name=name), len(logs)))
    base = fitted(problem_of_logs(SEDAN, logs))
    best, *others = with_terms(base, ranked_terms(base))
    assert all(other.log_evidence <= best.log_evidence for other in others)
    assert best.log_evidence > base.log_evidence
    assert best.mean_square < base.mean_square
    return best


def test_pads_of_one_axle_that_depend_on_the_speed():
    hidden = EmpiricalTerm("rear_brakes", "speed", (5.0, 15.0, 25.0, 35.0), (0.0, -0.15, 0.1, 0.1))
    best = best_with(hidden)
    (term,) = best.effects.terms
    assert (term.place, term.driver) == (hidden.place, hidden.driver)
    v = np.array(term.knots)
    friction = best.base.pad_friction_r * (1.0 + np.array(term.values))
    true = SEDAN.rear.pad_friction * (1.0 + np.interp(v, hidden.knots, hidden.values))
    assert friction == pytest.approx(true, rel=0.03)
    assert best.base.pad_friction_f == pytest.approx(SEDAN.front.pad_friction, rel=0.02)


@pytest.mark.slow
def test_what_depends_on_the_pressure_in_front_is_put_there():
    """A torque on the pads or on the wheels: no log tells these apart."""
    hidden = EmpiricalTerm("front_brakes", "pressure", (0.0, 5e5, 15e5, 4e6), (0.0, -0.2, 0.0, 0.1))
    (term,) = best_with(hidden).effects.terms
    assert (PLACES[term.place], term.driver) == ("front", "pressure")


def test_the_precision_of_a_walk_is_that_of_its_increments():
    """Closed form: values are sums of independent increments, the first of five times the size."""
    walk = Walk("body", "speed", (0.0, 1.0, 2.0, 3.0), 0.01)
    sums = np.tril(np.ones((4, 4)))
    increments = 0.01 * np.array([5.0, 1.0, 1.0, 1.0])
    covariance = sums @ np.diag(increments**2) @ sums.T
    assert np.linalg.inv(walk.precision) == pytest.approx(covariance)


def test_a_ripple_pays_for_the_angle_that_was_taken_from_every_run():
    """Closed form: of noise alone, an amplitude with the best angle of each of n runs gains n pi/4.

    The length of a plane vector of unit noise is Rayleigh's, with the mean sqrt(pi/2).
    """
    for name in ("disc_thickness_variation", "tone_ring_runout"):
        paid = Hypothesis((name,)).price(40) - Hypothesis(("road_grade",)).price(40)
        assert paid > 40 * np.pi / 4.0
