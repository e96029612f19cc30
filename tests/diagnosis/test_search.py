"""What a search makes of cars of the hidden plant: what a user may rely on."""

from dataclasses import replace

import numpy as np
import pytest

import calib
from calib.base.processes import parallel_map
from calib.car.effects.effects import Effects
from calib.diagnosis.fits import Fits
from calib.diagnosis.search import Search
from calib.logs.log import Log
from calib.model.sensor_noise import add_noise
from tests.support.effect_runs import SEDAN
from tests.support.explained import fitted, problem_of_logs, search_in
from tests.support.hidden.cases import HiddenCase, draw

FEW = ("coast", "coast_slow", "hot", "stop_a")


def search_of(case: HiddenCase) -> Search:
    return search_in(case.vehicle, case.calibration, case.holdout)


@pytest.fixture(scope="module")
def pair() -> Search:
    """More drag on a road that slopes: a bias of the accelerometer imitates both."""
    names, few = ("aerodynamic_drag", "road_grade"), ("coast", "coast_slow", "ramp_fast", "stop_a")
    return search_of(draw("double", 4, names, severity=2, only=few))


def test_two_effects_are_found_although_a_third_imitates_both(pair):
    assert set(pair.best.names) == {"aerodynamic_drag", "road_grade"}
    assert pair.best.mean_square < 1.05
    assert not pair.rivals
    assert (pair.steps[0], set(pair.steps[-1])) == ((), set(pair.best.names))
    others = [fit for fit in pair.fits.fitted.values() if set(fit.names) != set(pair.best.names)]
    assert pair.best.log_evidence > max(fit.log_evidence for fit in others)


def test_a_part_promises_the_evidence_of_its_fit(pair, monkeypatch):
    """The linear model is good for a group, and for an effect that is hardly there."""
    names, promised = pair.best.names, []
    monkeypatch.setattr(Fits, "is_known", lambda _, part, evidence: promised.append(evidence))
    for wider, groups in (((*names, "rolling_resistance"), []), (names, ["slope"])):
        fit = fitted(pair.problem, wider, groups)
        (part,) = pair.fits.without_each(fit, wider[len(names) :])
        assert promised.pop() == pytest.approx(part.log_evidence, abs=1.5)


def test_the_density_of_hold_outs_is_that_of_the_whole_hypothesis(pair):
    """Pads of this plant are the same in all logs. The best fit, which says so, foresees more."""
    usual = replace(pair.best, hypothesis=replace(pair.best.hypothesis, alike=frozenset()))
    assert pair.fits.density(pair.best) > pair.fits.density(usual) + 1.0


@pytest.mark.parametrize(
    ("share", "names"),
    [(1.0, ()), pytest.param(0.5, ("aerodynamic_drag",), marks=pytest.mark.slow)],
)
def test_a_known_effect_is_named_only_where_its_size_is_wrong(share, names):
    """Beside radii that are 0.3 % off."""
    case = draw("single", 12, ("aerodynamic_drag",), severity=1, only=FEW)
    area = case.hidden.drag_area
    in_file = Effects({"aerodynamic_drag": {"drag_area": share * area}})
    car = replace(case.vehicle.with_radii(1.003), effects=in_file)
    best = search_of(replace(case, vehicle=car)).best
    assert best.names == names
    estimate = best.effects.parameters["aerodynamic_drag"]["drag_area"]
    assert estimate == pytest.approx(area, rel=0.03)
    assert best.base.radius == pytest.approx(1.0 / 1.003, abs=2e-4)


HEATS = {(60.0, 60.0): 18, (300.0, 140.0): 22, (380.0, 240.0): 34}
"""First heats of discs [degC], front and rear, with the pressure of the stop [bar]."""


@pytest.fixture(scope="module")
def hot_stops() -> list[Log]:
    """Stops that begin with these heats; no temperature is logged."""
    effects = Effects({"pad_thermal_fade": {"fade_slope": 0.0012, "fade_onset": 150.0}})
    model, logs = replace(calib.default_model(SEDAN), effects=effects), []
    time = np.arange(0.0, 9.0, 0.005)
    for heat, pressure in HEATS.items():
        p = np.clip(20e5 * (time - 1.5), 0.0, 1e5 * pressure)
        log = calib.simulate(model, time, p, 35.0, start_heat=heat, name=f"at {pressure} bar")
        logs.append(add_noise(log, pressure))
    return logs


def test_discs_that_begin_unlike_are_told_by_their_fade(hot_stops):
    problem, fade = problem_of_logs(SEDAN, hot_stops), ("pad_thermal_fade",)
    best = fitted(problem, fade, ["heat"])
    assert best.log_evidence > 100.0 + fitted(problem, fade).log_evidence
    # heats and onset count from each other alone, so what is above the onset is compared
    parameters = best.effects.parameters["pad_thermal_fade"]
    assert parameters["fade_slope"] == pytest.approx(0.0012, rel=0.05)
    # pads repeat to 2 %, which is 17 K of such a fade
    above = np.array([run.start_heat for run in best.runs]) - parameters["fade_onset"]
    assert above[1:] == pytest.approx(np.array(list(HEATS))[1:] - 150.0, abs=50.0)


@pytest.mark.slow
def test_two_processes_find_what_one_does(pair):
    with parallel_map(2, "calib.diagnosis.search") as mapped:
        problem = replace(pair.problem, mapped=mapped)
        holdout_problem = replace(pair.holdouts.problem, mapped=mapped)
        together = Search(problem, replace(pair.holdouts, problem=holdout_problem))
        together.run()
    assert together.steps == pair.steps
    assert together.best.state.x == pytest.approx(pair.best.state.x, rel=1e-6, abs=1e-9)
