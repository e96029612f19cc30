"""Each log on a road of its own slope, or with a zero of the accelerometer of its own."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import calib
from calib.base.names import G
from calib.diagnosis.explanation.channels import CHANNELS
from calib.diagnosis.explanation.fit import fit_base
from calib.diagnosis.explanation.offsets import GRADE, ZERO, as_effects
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.search.offsets import differ
from calib.diagnosis.written.document import to_dict
from calib.model.sensor_noise import add_noise
from tests.support.effect_runs import SEDAN
from tests.support.explained import diagnosed
from tests.support.hidden.cases import draw

TIME = np.arange(0.0, 6.0, 0.01)
BOTH = pytest.mark.parametrize(("effect", "most"), [(GRADE, 0.02), (ZERO, 0.2)])


def ramp(effect, size, seed):
    """A ramp of the sedan on a slope, or with a zero of a_x, by the simulation."""
    model = replace(calib.default_model(SEDAN), effects=as_effects(effect, size))
    p = np.clip(10e5 * (TIME - 2.0), 0.0, 25e5)
    return add_noise(calib.simulate(model, TIME, p, 30.0, name=f"ramp {seed}"), seed)


def problem(effect, sizes):
    runs = [run_of(ramp(effect, size, seed)) for seed, size in enumerate(sizes)]
    return replace(problem_of(SEDAN, runs), offset=effect)


@pytest.fixture(scope="module")
def level():
    return {effect: problem(effect, (0.0,)) for effect in (GRADE, ZERO)}


@BOTH
@given(share=st.floats(-1.0, 1.0))
def test_the_course_is_that_of_the_equations(level, effect, most, share):
    """v = 12 - g s t, and a_x reads b more: closed forms."""
    size, course = share * most, level[effect].courses[0]
    time = 0.02 * np.arange(course.raw.size)
    made = np.zeros((len(CHANNELS), time.size))
    if effect == GRADE:
        made[CHANNELS.index("v")] = 12.0 - G * size * time
    else:
        made[CHANNELS.index("a_x")] = size
    assert course.offset(made) == pytest.approx(size, abs=1e-9)


@BOTH
def test_innovations_do_not_show_an_offset(level, effect, most):
    course = level[effect].courses[0]
    random = np.random.default_rng(7)
    plain = [random.standard_normal(course.white.size) for _ in CHANNELS]
    moved = [x + (c == course.channel) * most * course.white for c, x in enumerate(plain)]
    for one, other in zip(course.removed(plain), course.removed(moved), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)


@BOTH
def test_offsets_of_simulated_logs_are_found_against_each_other(effect, most):
    sizes = np.array([0.0, most, -0.5 * most])
    asked = problem(effect, sizes)
    base = fit_base(asked)
    found = np.array(asked.offsets(base.base, base.effects))
    np.testing.assert_allclose(found - found[0], sizes, atol=0.05 * most)


@BOTH
def test_logs_differ_where_their_offsets_do(effect, most):
    alike, apart = problem(effect, (most,) * 4), problem(effect, (most, 0.0, -most, 0.5 * most))
    assert not differ(alike.runs, alike.noise)
    assert differ(apart.runs, apart.noise)
    assert not differ(apart.runs[:1], apart.noise)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "named", "driven", "margin"), [(2, GRADE, "grade", 0.002), (0, ZERO, "bias", 0.02)]
)
def test_an_effect_is_named_beside_offsets_of_the_logs(seed, named, driven, margin):
    """On the independent plant, whose braking has a cause of its own."""
    case = draw("offsets", seed, names=("pad_pressure_dependence",), severity=1)
    found = diagnosed(case)
    assert [effect.name for effect in found.effects] == ["pad_pressure_dependence"]
    assert found.unexplained is None
    assert found.warnings == ()
    logs = [log.name for log in (*case.calibration, *case.holdout)]
    grounds = zip(logs, case.answer["variety"]["grounds"], strict=True)
    truth = {log: ground[driven] for log, ground in grounds}
    assert found.offsets.effect == named
    assert found.offsets.values == pytest.approx(truth, abs=margin)
    assert to_dict(found)["log_offsets"]["values"] == found.offsets.values
