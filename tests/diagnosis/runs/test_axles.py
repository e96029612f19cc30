"""Front and rear wheel speeds that are swapped are refused; a motor at the rear is no swap."""

import pytest

from calib.base.errors import LogError
from calib.diagnosis.diagnose import diagnose
from tests.support.explained import diagnosed
from tests.support.hidden.cases import draw
from tests.support.reference_car import swapped

FEW = ("coast", "ramp", "hot", "mixed")


@pytest.mark.parametrize("every", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_swapped_axles_are_refused_by_the_logs_in_which_they_show(every):
    case = draw("none", 60, only=FEW)
    logs = [swapped(log) for log in case.calibration] if every else list(case.calibration)
    with pytest.raises(LogError, match="axles_swapped") as error:
        diagnose(case.vehicle, logs, [swapped(log) for log in case.holdout])
    told = {"mixed.csv", "ramp.csv", "hot.csv"} if every else {"mixed.csv"}
    assert set(str(error.value.where).split(", ")) == told


@pytest.mark.slow
def test_a_motor_on_the_rear_axle_is_no_swap():
    case = draw("single", 41, names=("regenerative_torque",), severity=2)
    assert case.hidden.regen_axle == 1
    assert [effect.name for effect in diagnosed(case).effects] == ["regenerative_torque"]
