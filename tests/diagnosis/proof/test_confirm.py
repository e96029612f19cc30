"""What a further effect explains beyond the form of those before, in squares by run and channel."""

import numpy as np
import pytest

from calib.diagnosis.explanation.predict import run_of
from calib.diagnosis.explanation.problem import problem_of
from calib.diagnosis.proof.confirm import beyond_form, second_shown
from calib.diagnosis.search.decide import Decision
from calib.diagnosis.search.search import added
from tests.support.explained import based
from tests.support.hidden.cases import draw

CHANNELS, V, RIPPLE = 6, 2, 4


def squares(v: float, ripple: float) -> np.ndarray:
    """Two runs; what is left in v, and in left less right of the rear wheels."""
    out = np.full((2, CHANNELS), 100.0)
    out[:, V] += v
    out[:, RIPPLE] += ripple
    return out


@pytest.mark.parametrize(
    ("before", "at", "option", "form", "beyond"),
    [
        # a ripple beside a delay of v counts in full
        (squares(50_000.0, 300.0), squares(200.0, 300.0), squares(200.0, 0.0), 0.03, 2 * 300.0),
        # a share of the first effect in its own channel counts for nothing
        (squares(50_000.0, 0.0), squares(1000.0, 0.0), squares(0.0, 0.0), 0.03, 0.0),
        (squares(50_000.0, 0.0), squares(1000.0, 0.0), squares(0.0, 0.0), 0.01, 2 * 510.0),
        # what grows elsewhere is not taken off
        (squares(0.0, 300.0), squares(0.0, 300.0), squares(40.0, 0.0), 0.0, 2 * 300.0),
    ],
)
def test_what_is_beyond_the_form_of_the_first_effect_counts(before, at, option, form, beyond):
    assert beyond_form(before, at, option, form) == pytest.approx(beyond)


def test_uneven_teeth_are_shown_beside_a_large_delay_of_v():
    case = draw("double", 1320003, only=("ramp", "coast", "step_high", "hot_stop"))
    assert set(case.effects) == {"tone_ring_runout", "speed_delay"}
    base = based(case)
    first = added(base, "speed_delay")
    both = added(first, "tone_ring_runout")
    held = problem_of(case.vehicle, [run_of(case.holdout[0])])
    assert second_shown(Decision("named", base, both, (), first=first), held)
    alike = added(first, "accelerometer_bias")  # is not there
    assert not second_shown(Decision("named", base, alike, (), first=first), held)
