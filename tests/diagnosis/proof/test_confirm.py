"""What a further effect explains beyond the form of those before, in squares by run and channel."""

import numpy as np
import pytest

from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.proof.confirm import beyond_form, second_shown
from calib.diagnosis.search.decide import Decision
from calib.diagnosis.search.search import added
from tests.support.hidden.cases import draw

CHANNELS, V, RIPPLE = 6, 2, 4


def squares(v: float, ripple: float) -> np.ndarray:
    """Two runs; what is left in v, and in left less right of the rear wheels."""
    out = np.full((2, CHANNELS), 100.0)
    out[:, V] += v
    out[:, RIPPLE] += ripple
    return out


def test_a_ripple_beside_a_delay_of_v_counts_in_full():
    before, at, option = squares(50_000.0, 300.0), squares(200.0, 300.0), squares(200.0, 0.0)
    assert beyond_form(before, at, option, 0.03) == pytest.approx(2 * 300.0)


def test_what_is_a_share_of_the_first_effect_in_its_own_channel_counts_for_nothing():
    before, at, option = squares(50_000.0, 0.0), squares(1000.0, 0.0), squares(0.0, 0.0)
    assert beyond_form(before, at, option, 0.03) == 0.0
    assert beyond_form(before, at, option, 0.01) == pytest.approx(2 * (1000.0 - 490.0))


def test_what_grows_elsewhere_is_not_taken_off():
    before, at, option = squares(0.0, 300.0), squares(0.0, 300.0), squares(40.0, 0.0)
    assert beyond_form(before, at, option, 0.0) == pytest.approx(2 * 300.0)


def test_uneven_teeth_are_shown_beside_a_large_delay_of_v():
    case = draw("double", 1320003)
    assert set(case.effects) == {"tone_ring_runout", "speed_delay"}
    kept = [run_of(x) for x in case.calibration if x.name in ("ramp", "coast", "step_high")]
    problem = problem_of(case.vehicle, kept)
    base = fit(problem, (), np.zeros(BASE))
    first = added(base, "speed_delay")
    both = added(first, "tone_ring_runout")
    held = problem_of(case.vehicle, [run_of(case.holdout[0])])
    assert second_shown(Decision("named", base, both, (), first=first), held)
    alike = added(first, "accelerometer_bias")  # is not there
    assert not second_shown(Decision("named", base, alike, (), first=first), held)
