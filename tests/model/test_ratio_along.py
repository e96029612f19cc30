"""A pads' ratio that changes along a ramp: its form, and what a fit makes of it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.fitting.fit import fit
from calib.model.ratio_along import ratio_along
from calib.run.axle_signals import signals
from calib.run.blocks import blocks
from tests.support.plant import per_pascal
from tests.support.reference_car import CAR, REAL, cut, noisy, ramp, without

SLOPE, BEGIN = 5e5, 1.5
"""The ramp of the reference car: pressure [Pa/s] from a time [s] on."""


@pytest.fixture(scope="module")
def b():
    return blocks(signals(ramp(), CAR))


def test_a_drift_is_linear_in_the_speed_and_nothing_on_average(b):
    braked = b.z > 0.05
    told = ratio_along(b, braked, 0.04, 0.0)
    assert np.average(told[braked], weights=b.z[braked]) == pytest.approx(0.0, abs=1e-12)
    # 4 % for 15 m/s, and up where the car gets slower
    assert np.ptp(told[braked]) == pytest.approx(0.04 * np.ptp(b.speed[braked]) / 15.0)
    assert np.all(np.diff(told[braked]) > 0.0)


def test_pressures_that_are_apart_count_less_the_more_there_is(b):
    braked = b.p_f > 5e5
    told = ratio_along(b, braked, 0.0, 3e4)[braked]
    exact = np.log((b.p_f[braked] - 1.5e4) / (b.p_r[braked] + 1.5e4))
    assert told == pytest.approx(exact, rel=1e-3)


def drifting(ratio: float, apart: float):
    """The reference car with front pads that get better while it slows, and rear ones worse.

    ``ratio`` by which theirs rises for 15 m/s; ``apart`` pressure [Pa] that the front one lacks.
    """

    def pads(t: float) -> tuple[float, float]:
        p = SLOPE * max(t - BEGIN, 0.0)
        lost = 9.81 * per_pascal(CAR) * 0.5 * SLOPE * max(t - BEGIN, 0.0) ** 2
        half = 0.5 * ratio * (lost - 7.5) / 15.0
        front = 0.38 * math.exp(half) * max(1.0 - apart / max(p, 1.0), 0.0)
        return front, 0.38 * math.exp(-half)

    return ramp(replace(REAL, pads=pads), SLOPE)


@pytest.fixture(scope="module", params=[(0.05, 0.0), (-0.05, 0.0), (0.0, 5e4), (0.0, -5e4)])
def log(request):
    return drifting(*request.param)


@pytest.mark.parametrize("v", [True, False], ids=["with v", "without v"])
def test_pads_that_drift_are_not_taken_for_other_pads(log, v):
    """What a ramp of a car as declared says, where its ratio bends by some per cent."""
    braked = cut(log, 3.0)
    z = -braked["a_x"]
    true = {a: np.average(braked.truth[f"true_mu_pad_{a}"], weights=z) for a in "fr"}
    for seed in range(3):
        seen = noisy(log, seed)
        c = fit(CAR, [seen if v else without(seen, "v")]).calibration
        for found, mu in ((c.pad_friction_f, true["f"]), (c.pad_friction_r, true["r"])):
            assert abs(found.value - mu) < 2.5 * found.sigma
        assert c.pad_log_ratio.value == pytest.approx(math.log(true["f"] / true["r"]), abs=0.09)
