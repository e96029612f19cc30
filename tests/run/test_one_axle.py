"""The axle that brakes alone, from pressures only."""

from dataclasses import replace

import numpy as np
import pytest

from calib.run.blocks import braked_alone, braked_alone_in
from tests.support.one_axle import one_axle
from tests.support.reference_car import IDEAL, noisy, ramp, without

RISING = np.linspace(0.0, 40e5, 50)


def test_an_axle_below_the_bite_is_released():
    below, above = np.full(50, 1.4e5), np.full(50, 1.6e5)
    assert braked_alone(RISING, below) == "f"
    assert braked_alone(below, RISING) == "r"
    assert braked_alone(RISING, above) is None
    assert braked_alone(RISING, RISING) is None
    assert braked_alone(below, below) is None


@pytest.mark.parametrize("axle", ["f", "r"])
def test_a_log_tells_by_its_wheel_pressures(axle):
    log = noisy(one_axle(IDEAL, axle, held=0.5e5), 0)
    assert braked_alone_in(log) == axle
    renamed = replace(log, name="ramp with both axles", source="both.csv")
    assert braked_alone_in(renamed) == axle
    other = [f"p_{a}{s}" for a in "fr" for s in "lr"]
    assert braked_alone_in(without(log, *other)) is None
    assert braked_alone_in(without(log, "p_mc")) is None


def test_a_ramp_of_both_axles_has_none():
    assert braked_alone_in(noisy(ramp(IDEAL), 0)) is None
