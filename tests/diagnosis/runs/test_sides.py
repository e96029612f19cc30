from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.runs.sides import LARGEST, USUAL, with_even_sides
from tests.support.explained import diagnosed
from tests.support.hidden.cases import draw

FEW = ("coast", "ramp", "hot")


def changed(log, factors):
    return replace(
        log,
        channels={
            k: v * factors.get(k.removeprefix("omega_"), 1.0) for k, v in log.channels.items()
        },
    )


def test_unlike_radii_of_left_and_right_are_taken_out_and_axles_stay():
    logs = draw("none", 11, only=FEW).calibration
    even, plain = with_even_sides(logs, USUAL)
    again, sides = with_even_sides(
        [changed(log, {"fl": 1.0005, "fr": 0.9997, "rr": 1.0006}) for log in logs], USUAL
    )
    for one, other in zip(even, again, strict=True):
        for axle, mean in (("f", np.sqrt(1.0005 * 0.9997)), ("r", np.sqrt(1.0006))):
            for side in "lr":
                name = f"omega_{axle}{side}"
                assert other[name] == pytest.approx(mean * one[name], rel=1e-9)
    assert sides["f"] - plain["f"] == pytest.approx(-0.0008, abs=2e-6)
    assert sides["r"] - plain["r"] == pytest.approx(0.0006, abs=2e-6)


def test_more_than_tyres_make_is_left_in():
    logs = [changed(log, {"rl": 1.003}) for log in draw("none", 11, only=FEW).calibration]
    for log, even in zip(logs, with_even_sides(logs, USUAL)[0], strict=True):
        assert np.array_equal(even["omega_rl"], log["omega_rl"])
    assert with_even_sides(logs, LARGEST)[1]["r"] == pytest.approx(-0.003, abs=2e-4)


@pytest.mark.slow
def test_a_wheel_whose_brake_drags_is_no_new_tyre():
    few = ("coast", "ramp", "step_high", "hot_stop")
    found = diagnosed(draw("outside", 3, names=("seized_wheel",), only=few))
    assert found.verdict == "unknown"
    assert found.sides["r"] == 0.0
