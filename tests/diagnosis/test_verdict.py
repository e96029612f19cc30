"""From a search to a verdict, and where an unknown cause is put, on plants and known logs."""

from dataclasses import replace

import numpy as np
import pytest

import calib
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.diagnosis.explanation.channels import CHANNELS, STEP
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.unknowns import RANDOM_EFFECTS
from calib.diagnosis.replays import HoldOuts, gap_of, holdout_effects, replayed
from calib.diagnosis.verdict import Oscillation, held_from, oscillation_of, verdict_of
from calib.model.sensor_noise import add_noise
from tests.support.effect_runs import SEDAN
from tests.support.explained import fitted, left_in, problem_of_logs, search_in
from tests.support.hidden.cases import HiddenCase, draw
from tests.support.reference_car import CAR, IDEAL, noisy, ramp, stop
from tests.support.rounding import moved

RAMP_TIME = np.arange(0.0, 6.0, 0.01)
SIZES = {"slope": 0.02, "zero": 0.2}


def offset_logs(group: str, shares: list[float], first: int = 0):
    """Ramps of the sedan, each on a slope or with a zero of a_x of its own, by the simulation."""
    p, logs = np.clip(10e5 * (RAMP_TIME - 2.0), 0.0, 25e5), []
    for i, share in enumerate(shares, first):
        size = share * SIZES[group]
        effects = {"road_grade": {"grade": size, "felt": 1.0}, "accelerometer_bias": {"bias": size}}
        name = "road_grade" if group == "slope" else "accelerometer_bias"
        model = replace(calib.default_model(SEDAN), effects=Effects({name: effects[name]}))
        logs.append(add_noise(calib.simulate(model, RAMP_TIME, p, 30.0, name=f"ramp {i}"), i))
    return logs


@pytest.mark.parametrize("group", list(SIZES))
def test_each_log_has_its_own_slope_or_zero_and_hold_outs_are_replayed_with_theirs(group):
    shares, holdout_shares = [0.0, 1.0, -0.5], [0.7, -1.0]
    problem = problem_of_logs(SEDAN, offset_logs(group, shares))
    logs = offset_logs(group, holdout_shares, 7)
    holdout_problem = replace(problem, runs=tuple(run_of(log) for log in logs))
    fit = fitted(problem, groups=[group])
    place = RANDOM_EFFECTS.index(group)
    # four standard deviations of a difference of two, of what a log says of it beside its pads
    N = fit.random_columns(0)[[0, 1, 2, place]] * fit.hypothesis.sigmas[[0, 1, 2, place], None]
    sd = np.sqrt(np.linalg.inv(np.eye(4) + N @ N.T)[3, 3]) * fit.hypothesis.sigmas[place]
    within = 4.0 * np.sqrt(2.0) * float(sd)
    result = fit.state.random_effects[:, place]
    assert result - result[0] == pytest.approx(SIZES[group] * np.array(shares), abs=within)
    of_holdouts = holdout_effects(holdout_problem, fit)[:, place]
    expected = SIZES[group] * np.array(holdout_shares)
    assert of_holdouts - result[0] == pytest.approx(expected, abs=within)
    holdouts, base = HoldOuts(tuple(logs), holdout_problem), fitted(problem)
    after, plain = replayed(holdouts, fit, base), replayed(holdouts, base, base)
    assert gap_of(plain.logs, after.logs, logs).closed > 0.5
    assert not np.any(plain.random_effects[:, place])
    assert not np.any(plain.simulated.state.discrepancy)


def test_an_effect_that_makes_the_hold_outs_worse_is_withdrawn():
    """The hold-outs are of the car without drag: a drag that is named would add a gap to them."""
    car = replace(IDEAL, drag_area=0.66)
    logs = [noisy(ramp(car), 1), noisy(stop(car, 30e5), 4)]
    search = search_in(CAR, logs, [noisy(stop(IDEAL, 20e5), 3)])
    assert ("aerodynamic_drag",) in search.withdrawn.values()
    assert search.best.names == ()
    result = verdict_of(search)
    assert (result.word, result.best.names) == ("unknown", ())
    # what the calibration logs have and no effect may explain is told with its driver
    assert result.term.effects.terms[0].place == "body"
    assert result.term.effects.terms[0].driver == "speed"
    assert result.term.mean_square < 1.1 < search.base.mean_square


FEW = ("ramp", "release", "coast", "step_high")


def hiding(name: str, seed: int, severity: int = 2, only: tuple[str, ...] = FEW) -> HiddenCase:
    return draw("outside", seed, names=(name,), severity=severity, only=only)


def test_what_turns_with_the_front_wheels_is_told_by_their_angle():
    result = left_in(hiding("tone_ring_runout", 31, only=FEW[:3]))
    assert result.driver == "wheel_angle"
    assert result.axle == "front"
    assert 0.5 < result.turning <= 1.0


def test_a_wheel_that_always_drags_depends_on_nothing_whatever_the_last_digits():
    """With secant updates two of five said pressure instead of constant."""
    result = left_in(moved(hiding("seized_wheel", 32, only=("ramp", "coast")), 1))
    assert (result.place, result.driver) == ("rear_wheels", "constant")
    assert result.wheel is not None
    assert result.wheel.startswith("rear_")
    assert result.turning < 0.05


@pytest.mark.slow
def test_liquid_that_swings_in_a_tank_is_told_by_its_frequency():
    result = left_in(case := hiding("tank_slosh", 35))
    assert (result.axle, result.driver) == ("body", "frequency")
    # a mass on a spring, beside a car that it moves with
    mass, natural = case.hidden.slosh_mass, case.hidden.slosh_frequency
    assert result.oscillation.frequency == pytest.approx(natural / np.sqrt(1.0 - mass), rel=0.1)
    assert result.oscillation.share > 0.5


@pytest.mark.slow
def test_brakes_that_a_control_releases_go_with_the_slip():
    result = left_in(hiding("abs_modulation", 36, severity=1, only=("ramp", "coast", "step_high")))
    assert (result.axle, result.driver) == ("front", "slip")


@pytest.mark.slow
def test_brakes_that_weaken_go_with_the_time_of_the_run():
    """Beside a run that begins hot, for discs heat with every application."""
    result = left_in(hiding("weaker_applications", 33, only=(*FEW[:2], "hot")))
    assert (result.axle, result.wheel) == ("both", None)
    assert result.driver in ("elapsed", "distance")  # a run goes on over both
    assert 0.5 < result.explained <= 1.0


@pytest.mark.parametrize(("limit", "expected"), [(14e5, 15e5), (30e5, None)])
def test_a_torque_that_is_held_from_a_pressure_on_is_told(limit, expected):
    p = np.array([0.0, 1.5e5, 8e5, 15e5, 22e5, 29e5])
    factor = np.minimum(p, limit) / np.maximum(p, 1.0)
    values = tuple(np.where(p > 0.0, factor - 1.0, 0.0).tolist())
    term = EmpiricalTerm("front_brakes", "pressure", tuple(p.tolist()), values)
    assert held_from(term) == expected
    assert held_from(replace(term, place="body")) is None


TIME = np.arange(0.0, 120.0, STEP)


def swing_of(signal: np.ndarray, seed: int) -> Oscillation:
    """A signal in a_x beside noise of variance one in every channel."""
    noise = np.random.default_rng(seed).standard_normal((len(CHANNELS), TIME.size))
    noise[CHANNELS.index("a_x")] += signal
    return oscillation_of([noise], float(signal @ signal))


@pytest.mark.parametrize("frequency", [0.55, 0.6, 0.8, 1.1, 2.3])
def test_a_swing_is_found_with_its_frequency(frequency):
    """A swing that an application starts every 10 s, with a hundredth of critical damping."""
    since = TIME % 10.0
    swing = 5.0 * np.exp(-0.06 * frequency * since) * np.sin(2.0 * np.pi * frequency * since)
    result = swing_of(swing, 1)
    assert result.frequency == pytest.approx(frequency, abs=0.06)
    assert result.share > 0.7
    assert result.body


@pytest.mark.parametrize("time_constant", [0.1, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("apart", [3.0, 4.3, 6.1, 9.7])
def test_an_error_that_every_application_leaves_is_no_swing(time_constant, apart):
    """The answer to a lag: a step at the bite that dies away, and its opposite at the release."""
    since = TIME % apart
    half = 0.5 * apart
    released = np.where(since > half, np.exp(-(since - half) / time_constant), 0.0)
    error = np.exp(-since / time_constant) - released
    assert swing_of(10.0 * error, 2).share == 0.0
