"""Rolling radii that the vehicle file has wrong, and effects that it has right or wrong."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.diagnosis.explanation.vector import bounds, unpack
from calib.diagnosis.search.decide import decide
from calib.diagnosis.search.radii import with_free_radii
from calib.diagnosis.written.document import to_dict
from tests.support.explained import asked, based, diagnosed
from tests.support.hidden.cases import draw

FOUR = ("coast", "coast_slow", "hot", "ramp")


@pytest.fixture(scope="module")
def bare():
    return draw("none", 11, only=FOUR)


@pytest.mark.slow
def test_wrong_radii_are_found_and_no_effect_is_named_for_them(bare):
    factor = 0.999
    fixed = decide(based(replace(bare, vehicle=bare.vehicle.with_radii(factor))))
    assert fixed.best.names != ()  # a small torque looks like another radius
    free = with_free_radii(fixed)
    assert (free.verdict, free.best.names) == ("no_gap", ())
    assert free.best.base.radius == pytest.approx(1.0 / factor, abs=1e-4)


def test_right_radii_stay_those_of_the_file(bare):
    fixed = decide(based(bare))
    assert with_free_radii(fixed) is fixed


@pytest.mark.slow
def test_an_effect_beside_wrong_radii_is_named_with_its_size():
    case, factor = draw("single", 12, names=("aerodynamic_drag",), severity=1), 1.003
    found = diagnosed(replace(case, vehicle=case.vehicle.with_radii(factor)))
    assert [effect.name for effect in found.effects] == ["aerodynamic_drag"]
    low, high = found.effects[0].parameters["drag_area"].ci95
    assert low <= case.hidden.drag_area <= high
    assert found.base["rolling_radius"].value == pytest.approx(1.0 / factor, abs=2e-4)
    assert found.gap.after < 1.5
    assert found.model_after.vehicle.front.rolling_radius == pytest.approx(
        case.vehicle.front.rolling_radius, rel=2e-4
    )


def declared(case, drag_area):
    return replace(case.vehicle, effects=Effects({"aerodynamic_drag": {"drag_area": drag_area}}))


def test_effects_of_the_vehicle_file_are_where_a_vector_counts_from(bare):
    problem = asked(replace(bare, vehicle=declared(bare, 0.7), calibration=bare.calibration[:1]))
    _, plain = unpack(problem, (), problem.start)
    assert plain.parameters == {"aerodynamic_drag": {"drag_area": 0.7, "load_share": 0.5}}
    ones = np.ones(problem.base_size + 3)
    _, moved = unpack(problem, ("aerodynamic_drag", "accelerometer_bias"), ones)
    spread = moved.parameters["aerodynamic_drag"]["drag_area"] - 0.7
    low, _ = bounds(problem, ("aerodynamic_drag",))
    assert low[-2] == pytest.approx(-0.7 / spread)
    assert set(moved.parameters) == {"aerodynamic_drag", "accelerometer_bias"}


@pytest.mark.slow
@pytest.mark.parametrize("share", [1.0, 0.5])
def test_a_declared_effect_is_known_and_named_only_where_its_size_is_wrong(share):
    case = draw("single", 12, names=("aerodynamic_drag",), severity=2)
    car = declared(case, share * case.hidden.drag_area)
    found = diagnosed(replace(case, vehicle=car))
    names = [effect.name for effect in found.effects]
    assert names == ([] if share == 1.0 else ["aerodynamic_drag"])
    kept = found.model_after.effects.parameters["aerodynamic_drag"]["drag_area"]
    assert kept == pytest.approx(case.hidden.drag_area, rel=0.03)
    assert to_dict(found)["known"] == {
        "aerodynamic_drag": dict(car.effects.parameters["aerodynamic_drag"])
    }
