"""What several effects do together: sums that are sums, and nothing where there is nothing."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import ModelError
from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.combined import (
    as_driven,
    as_read,
    caliper_pressure,
    chosen,
    line_pressure,
    pad_factors,
    total_axle_moment,
    total_body_force,
    total_load_shift,
    wheel_factors,
)
from calib.car.effects.effect import acts_on_brakes, slows
from calib.car.effects.effects import Effects, EmpiricalTerm
from tests.support.effect_runs import SEDAN, made_history, made_motion
from tests.support.tables import VEHICLE

MOTION = made_motion([5.0, 20.0, 40.0])
ALL = sorted(CATALOGUE)


def test_an_unknown_effect_is_refused():
    with pytest.raises(ModelError, match="'fad'"):
        total_body_force(VEHICLE, Effects({"fad": {}}), MOTION)


def test_no_effects_are_zero_in_the_shape_of_the_motion():
    assert np.array_equal(total_body_force(VEHICLE, Effects(), MOTION), np.zeros(3))
    for moment in total_axle_moment(VEHICLE, Effects(), MOTION):
        assert np.array_equal(moment, np.zeros(3))


@given(st.floats(0.0, 2.0), st.floats(0.0, 0.05))
def test_totals_are_the_sums_worked_out_here(area, c_rr):
    both = Effects(
        {
            "aerodynamic_drag": {"drag_area": area},
            "rolling_resistance": {"coefficient": c_rr},
        }
    )
    force = total_body_force(VEHICLE, both, MOTION)
    front, rear = total_axle_moment(VEHICLE, both, MOTION)
    assert force == pytest.approx(0.6 * area * np.array([25.0, 400.0, 1600.0]))
    assert front == pytest.approx(np.full(3, c_rr * 1e4 * 0.322))
    assert rear == pytest.approx(np.full(3, c_rr * 7e3 * 0.322))


def test_totals_add_up_for_all_effects_together():
    typical = Effects({n: {p.name: p.typical for p in CATALOGUE[n].card.parameters} for n in ALL})
    apart = [typical.only(name) for name in ALL]
    summed = sum(total_body_force(VEHICLE, one, MOTION) for one in apart)
    assert total_body_force(VEHICLE, typical, MOTION) == pytest.approx(summed)
    for axle in (0, 1):
        summed = sum(total_axle_moment(VEHICLE, one, MOTION)[axle] for one in apart)
        assert total_axle_moment(VEHICLE, typical, MOTION)[axle] == pytest.approx(summed)


def test_a_term_adds_beside_the_named_causes():
    """A hundredth of the weight on the body, two hundredths on the rear wheels."""
    drag = {"aerodynamic_drag": {"drag_area": 0.5}}
    terms = tuple(
        EmpiricalTerm(place, "constant", (0.0,), (value,))
        for place, value in (("body", 0.01), ("rear_wheels", 0.02))
    )
    weight, both = 1744.0 * 9.80665, Effects(drag, terms)
    force = total_body_force(VEHICLE, both, MOTION)
    assert force == pytest.approx(0.3 * np.array([25.0, 400.0, 1600.0]) + 0.01 * weight)
    front, rear = total_axle_moment(VEHICLE, both, MOTION)
    assert np.array_equal(front, np.zeros(3))
    assert rear == pytest.approx(np.full(3, 0.02 * weight * 0.322))


def test_effects_are_chosen_by_what_they_do_and_terms_among_them():
    brakes, body = (
        EmpiricalTerm(place, "constant", (0.0,), (0.1,)) for place in ("brakes", "body")
    )
    parts = {"engine_drag": {"drag_torque": 1.0}, "hydraulic_delay": {"delay": 0.1}}
    sigma = {"engine_drag": {"drag_torque": 0.2}}
    effects = Effects(parts, (brakes, body), sigma)
    assert chosen(effects, acts_on_brakes) == Effects(
        {"hydraulic_delay": {"delay": 0.1}}, (brakes,)
    )
    assert chosen(effects, slows) == Effects({"engine_drag": parts["engine_drag"]}, (body,), sigma)


@pytest.mark.parametrize("name", ALL)
@given(data=st.data())
def test_at_nothing_no_link_of_the_chain_is_changed(name, data):
    """Whatever the other parameters are."""
    effect, history = CATALOGUE[name], made_history()
    own = {p.name: data.draw(st.floats(p.low, p.high)) for p in effect.card.parameters}
    own[effect.card.parameters[0].name] = effect.card.neutral
    effects, motion = Effects({name: own}), made_motion(history.v)
    line = line_pressure(effects, history)
    for p in (*line, *caliper_pressure(effects, history, *line)):
        assert np.array_equal(p, history.p_mc)
    for factor in pad_factors(effects, history, history.p_mc, history.p_mc):
        assert np.array_equal(factor, np.ones(200))
    for factor in wheel_factors(effects, history).values():
        assert np.array_equal(factor, np.ones(200))
    for moment in total_axle_moment(SEDAN, effects, motion):
        assert np.array_equal(moment, np.zeros(200))
    assert np.array_equal(total_body_force(SEDAN, effects, motion), np.zeros(200))
    assert np.array_equal(total_load_shift(SEDAN, effects, history), np.zeros(200))
    assert np.array_equal(as_read(SEDAN, effects, history, history.z), history.z)
    assert as_driven(SEDAN, effects) == SEDAN
