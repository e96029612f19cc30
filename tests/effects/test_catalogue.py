"""The catalogue: complete cards, one file each, and sums that are sums."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import calib.effects.catalogue as catalogue
from calib.effects.catalogue import CATALOGUE, effect_named, total_axle_moment, total_body_force
from calib.effects.effect import Motion
from calib.errors import ModelError
from calib.units import to_si
from tests.tables_made import VEHICLE

MOTION = Motion(np.array([5.0, 20.0, 40.0]), np.full(3, 1e4), np.full(3, 7e3))
ALL = sorted(CATALOGUE)
PARAMETERS = [(name, p) for name in ALL for p in CATALOGUE[name].card.parameters]


@pytest.mark.parametrize("name", ALL)
def test_a_card_says_everything(name):
    card = CATALOGUE[name].card
    assert card.name == name
    for text in (card.cause, card.equation, card.source, card.looks_like):
        assert text.strip()
    assert card.parameters


@pytest.mark.parametrize(("name", "p"), PARAMETERS, ids=lambda x: getattr(x, "name", x))
def test_a_parameter_has_an_si_unit_and_a_range_around_what_is_usual(name, p):
    assert to_si(1.0, p.unit, p.unit) == 1.0
    assert p.low <= p.typical <= p.high
    assert 0.0 < p.spread < p.high - p.low


def test_one_file_for_each_effect_and_one_effect_for_each_file():
    files = {path.stem for path in Path(catalogue.__file__).parent.glob("*.py")}
    assert files - {"__init__", "effect", "catalogue", "empirical"} == set(CATALOGUE)


def test_no_two_parameters_share_a_name():
    names = [p.name for _, p in PARAMETERS]
    assert len(set(names)) == len(names)


def test_an_unknown_effect_is_refused_with_the_known_ones():
    with pytest.raises(ModelError, match=r"'fad'.*aerodynamic_drag.*see calib/effects"):
        effect_named("fad")
    with pytest.raises(ModelError, match="'fad'"):
        total_body_force(VEHICLE, {"fad": {}}, MOTION)


def test_no_effects_are_nought_in_the_shape_of_the_motion():
    assert np.array_equal(total_body_force(VEHICLE, {}, MOTION), np.zeros(3))
    for moment in total_axle_moment(VEHICLE, {}, MOTION):
        assert np.array_equal(moment, np.zeros(3))


@given(st.floats(0.0, 2.0), st.floats(0.0, 0.05))
def test_totals_are_the_sums_worked_out_here(area, c_rr):
    both = {
        "aerodynamic_drag": {"drag_area": area},
        "rolling_resistance": {"coefficient": c_rr},
    }
    force = total_body_force(VEHICLE, both, MOTION)
    front, rear = total_axle_moment(VEHICLE, both, MOTION)
    assert force == pytest.approx(0.6 * area * np.array([25.0, 400.0, 1600.0]))
    assert front == pytest.approx(np.full(3, c_rr * 1e4 * 0.322))
    assert rear == pytest.approx(np.full(3, c_rr * 7e3 * 0.322))


def test_totals_add_up_for_all_effects_together():
    typical = {n: {p.name: p.typical for p in CATALOGUE[n].card.parameters} for n in ALL}
    apart = [{name: values} for name, values in typical.items()]
    summed = sum(total_body_force(VEHICLE, one, MOTION) for one in apart)
    assert total_body_force(VEHICLE, typical, MOTION) == pytest.approx(summed)
    for axle in (0, 1):
        summed = sum(total_axle_moment(VEHICLE, one, MOTION)[axle] for one in apart)
        assert total_axle_moment(VEHICLE, typical, MOTION)[axle] == pytest.approx(summed)
