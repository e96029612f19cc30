"""How much load a drag moves is found beside it, whether the drag is known or not."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.base import BASE
from calib.diagnosis.explanation.fit import fit
from calib.diagnosis.explanation.vector import unpack
from tests.support.explained import asked
from tests.support.hidden.cases import draw

DRAG = "aerodynamic_drag"


@pytest.fixture(scope="module")
def case():
    """Its drag acts at the height of the centre of gravity: it moves no load."""
    return draw("single", 10, names=(DRAG,), severity=1)


def problem(case, **known):
    car = replace(case.vehicle, effects=Effects({DRAG: known} if known else {}))
    return asked(replace(case, vehicle=car))


def test_the_share_of_a_hidden_drag_is_one_of_its_parameters(case):
    of = problem(case)
    assert of.base_size == BASE
    found = fit(of, (DRAG,), np.concatenate([of.start, [1.0, 0.0]]))
    assert found.effects.parameters[DRAG]["load_share"] == pytest.approx(0.0, abs=0.2)


def test_the_share_of_a_known_drag_is_a_base_parameter(case):
    found = fit(of := problem(case, drag_area=case.hidden.drag_area), (), of.start)
    assert of.base_size == BASE + 1
    assert found.names == ()
    assert found.effects.parameters[DRAG]["drag_area"] == case.hidden.drag_area
    assert found.effects.parameters[DRAG]["load_share"] == pytest.approx(0.0, abs=0.2)
    at_road = problem(case, drag_area=case.hidden.drag_area, load_share=1.0)
    assert found.chi2 < fit(at_road, (), at_road.start).chi2 - 25.0


def test_a_share_that_the_vehicle_file_gives_is_kept(case):
    of = problem(case, drag_area=0.7, load_share=0.3)
    assert of.base_size == BASE
    assert unpack(of, (), of.start)[1].parameters == {DRAG: {"drag_area": 0.7, "load_share": 0.3}}
