"""From a search to a verdict: hold-outs of a plant, and states of each log that are known."""

from dataclasses import replace

import numpy as np
import pytest

import calib
from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.base import OWN
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.replays import HoldOuts, gap_of, placed, replayed
from calib.diagnosis.verdict import NO_GAP, UNKNOWN, verdict_of
from calib.model.sensor_noise import add_noise
from tests.support.effect_runs import SEDAN
from tests.support.explained import asked, fitted, searched
from tests.support.reference_car import CAR, IDEAL, noisy, ramp, stop

TIME = np.arange(0.0, 6.0, 0.01)
SIZES = {"slope": 0.02, "zero": 0.2}


def offset_logs(kind: str, shares: list[float], first: int = 0):
    """Ramps of the sedan, each on a slope or with a zero of a_x of its own, by the simulation."""
    p, logs = np.clip(10e5 * (TIME - 2.0), 0.0, 25e5), []
    for i, share in enumerate(shares, first):
        size = share * SIZES[kind]
        own = {"road_grade": {"grade": size, "felt": 1.0}, "accelerometer_bias": {"bias": size}}
        name = "road_grade" if kind == "slope" else "accelerometer_bias"
        model = replace(calib.default_model(SEDAN), effects=Effects({name: own[name]}))
        logs.append(add_noise(calib.simulate(model, TIME, p, 30.0, name=f"ramp {i}"), i))
    return logs


@pytest.mark.parametrize("kind", list(SIZES))
def test_each_log_has_its_own_slope_or_zero_and_hold_outs_are_replayed_with_theirs(kind):
    known, held = [0.0, 1.0, -0.5], [0.7, -1.0]
    problem = asked(SEDAN, offset_logs(kind, known))
    logs = offset_logs(kind, held, 7)
    kept = replace(problem, runs=tuple(run_of(log) for log in logs))
    at = fitted(problem, kinds=[kind])
    place = OWN.index(kind)
    # four standard deviations of a difference of two, of what a log says of it beside its pads
    N = at.own_columns(0)[[0, 1, 2, place]] * at.hypothesis.sizes[[0, 1, 2, place], None]
    sd = np.sqrt(np.linalg.inv(np.eye(4) + N @ N.T)[3, 3]) * at.hypothesis.sizes[place]
    within = 4.0 * np.sqrt(2.0) * float(sd)
    found = at.state.own[:, place]
    assert found - found[0] == pytest.approx(SIZES[kind] * np.array(known), abs=within)
    placed_at = placed(kept, at)[:, place]
    assert placed_at - found[0] == pytest.approx(SIZES[kind] * np.array(held), abs=within)
    proof, base = HoldOuts(tuple(logs), kept), fitted(problem)
    after, plain = replayed(proof, at, base), replayed(proof, base, base)
    assert gap_of(plain.logs, after.logs, logs).closed > 0.5
    assert not np.any(plain.own[:, place])
    assert not np.any(plain.at.state.form)


@pytest.fixture(scope="module")
def drag_in_calibration_alone():
    """The hold-outs are of the car without drag: a drag that is named would add a gap to them."""
    car = replace(IDEAL, drag_area=0.66)
    logs = [noisy(ramp(car), 1), noisy(stop(car, 15e5), 2), noisy(stop(car, 30e5), 4)]
    held = [noisy(stop(IDEAL, 20e5), 3), noisy(ramp(IDEAL, 4e5), 5)]
    return searched(CAR, logs, held)


def test_an_effect_that_makes_the_hold_outs_worse_is_withdrawn(drag_in_calibration_alone):
    search = drag_in_calibration_alone
    assert ("aerodynamic_drag",) in search.withdrawn.values()
    assert search.best.names == ()
    found = verdict_of(search)
    assert (found.word, found.best.names) == (UNKNOWN, ())
    # what the calibration logs have and no effect may explain is told with its driver
    assert found.terms[0].effects.terms[0].place == "body"
    assert found.terms[0].effects.terms[0].driver == "speed"
    assert found.terms[0].reduced < 1.1 < search.base.reduced


def test_a_car_that_lacks_nothing_has_no_gap_and_no_term():
    logs = [noisy(ramp(IDEAL), 1), noisy(stop(IDEAL, 15e5), 2), noisy(stop(IDEAL, 30e5), 4)]
    held = [noisy(stop(IDEAL, 20e5), 3)]
    found = verdict_of(searched(CAR, logs, held))
    assert (found.word, found.best.names, found.terms) == (NO_GAP, (), ())
    for before, after in zip(found.after.before, found.after.logs, strict=True):
        assert np.array_equal(before["v"], after["v"])
