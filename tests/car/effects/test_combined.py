"""Several effects together: their sums, and sets of effects that are joined."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.effects.combined import total_axle_moment, total_body_force
from calib.car.effects.effects import Effects, EmpiricalTerm
from tests.support.effect_runs import made_motion
from tests.support.tables import VEHICLE

MOTION = made_motion([5.0, 20.0, 40.0])
DRAG = {"aerodynamic_drag": {"drag_area": 0.6}}
ROLLING = {"rolling_resistance": {"coefficient": 0.01}}
SIGMA = {"aerodynamic_drag": {"drag_area": 0.02}}
FADE = EmpiricalTerm("brakes", "temperature", (20.0, 300.0), (0.0, -0.1))
BODY_FORCE = EmpiricalTerm("body", "constant", (0.0,), (0.01,))


@given(st.floats(0.0, 2.0), st.floats(0.0, 0.05), st.floats(-0.1, 0.1))
def test_totals_are_the_sums_worked_out_here(area, c_rr, share):
    """The effects are drag, rolling resistance, and terms on the body and on the rear wheels."""
    terms = tuple(
        EmpiricalTerm(place, "constant", (0.0,), (share,)) for place in ("body", "rear_wheels")
    )
    named = {"aerodynamic_drag": {"drag_area": area}, "rolling_resistance": {"coefficient": c_rr}}
    effects, term_force = Effects(named, terms), share * 1744.0 * 9.80665
    force = total_body_force(VEHICLE, effects, MOTION)
    front, rear = total_axle_moment(VEHICLE, effects, MOTION)
    assert force == pytest.approx(0.6 * area * np.array([25.0, 400.0, 1600.0]) + term_force)
    assert front == pytest.approx(np.full(3, c_rr * 1e4 * 0.322))
    assert rear == pytest.approx(np.full(3, (c_rr * 7e3 + term_force) * 0.322))


def test_joined_effects_have_parameters_sigma_and_terms_of_the_other():
    both_effects = Effects(DRAG | ROLLING, (FADE,), SIGMA)
    larger_drag = Effects({"aerodynamic_drag": {"drag_area": 0.8}})
    assert both_effects.with_(larger_drag) == Effects(
        {"aerodynamic_drag": {"drag_area": 0.8}} | ROLLING, (FADE,)
    )
    assert larger_drag.with_(both_effects) == both_effects
    assert both_effects.with_(Effects(terms=(BODY_FORCE,))).terms == (BODY_FORCE,)
