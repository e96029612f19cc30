"""The level of the pads on ramps: how it moves with the pads' ratio, and shows that ratio."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.car.beliefs import LOG
from calib.car.effects.effects import Effects
from calib.fitting.pads import level_of, ratio_by_levels
from calib.run.resistance import Resistance
from calib.table.table import Value
from tests.support.reference_car import CAR, IDEAL, noisy, one_axle, prepared, ramp, rolled

SHARE = 28.84 * 130.9 / (28.84 * 130.9 + 11.34 * 124.0)
"""Share of the front brakes in the force at one pressure, Table I."""

SURE = Resistance(Effects(), ((0.0, 0.0), (0.0, 0.0)), specified=True)


@pytest.fixture(scope="module")
def runs():
    """After 4.5 s of rolling: the zero of a_x is then known far better than pads repeat."""
    driven = {"n": ramp(IDEAL), "f": one_axle(IDEAL, "f"), "r": one_axle(IDEAL, "r")}
    logs = {kind: rolled(log, 3.0, 0.0) for kind, log in driven.items()}
    return {kind: prepared(noisy(log, seed)) for seed, (kind, log) in enumerate(logs.items())}


def level(run, log_ratio):
    return level_of(CAR, [run], SURE, log_ratio)[0]


@pytest.mark.parametrize(("axle", "slope"), [("f", -0.5), ("r", 0.5), ("n", 0.5 - SHARE)])
def test_level_of_a_run_moves_with_the_ratio(runs, axle, slope):
    """ln of the level of one axle goes with -+ratio/2, that of both with (1/2 - share) ratio."""
    low, high = (np.log(level(runs[axle], x)) for x in (-0.01, 0.01))
    assert (high - low) / 0.02 == pytest.approx(slope, abs=0.01)


@pytest.mark.parametrize("axle", ["f", "r", "n"])
def test_the_zero_of_the_accelerometer_moves_no_level(runs, axle):
    """A hundredth of g, which is there on the lead-in, too: 2 to 10 % of what the ramps reach."""
    run = runs[axle]
    off = replace(run, brake_sum=run.brake_sum + 0.01 * CAR.weight)
    assert level(off, 0.0) == pytest.approx(level(run, 0.0))


def test_normal_ramps_tell_nothing_of_the_ratio(runs):
    prior = Value(0.03, 0.07)
    assert ratio_by_levels(CAR, [runs["n"], runs["n"]], SURE, prior) == prior


@pytest.mark.parametrize("axle", ["f", "r"])
def test_a_ramp_with_one_axle_tells_it_as_well_as_pads_repeat(runs, axle):
    """Two levels whose difference rises with the ratio; each is known as well as pads repeat."""
    lever = {"f": 1.0 - SHARE, "r": SHARE}[axle]
    ratio = ratio_by_levels(CAR, [runs["n"], runs[axle]], SURE, Value(0.0, 0.5))
    by_levels = math.sqrt(2.0) * LOG.pads_repeat.sigma / lever
    expected = 1.0 / math.hypot(1.0 / by_levels, 1.0 / 0.5)
    assert ratio.sigma == pytest.approx(expected, rel=0.15)
    assert abs(ratio.value) < 2.0 * ratio.sigma


def test_stronger_rear_pads_come_out(runs):
    """A tenth less pressure for the same force at the rear alone."""
    usual = runs["r"]
    weaker = replace(usual, blocks=replace(usual.blocks, p_r=usual.blocks.p_r / 1.1))
    same, other = (
        ratio_by_levels(CAR, [runs["n"], run], SURE, Value(0.0, 10.0)) for run in (usual, weaker)
    )
    assert other.value - same.value == pytest.approx(-math.log(1.1) / SHARE, rel=0.05)


def test_what_was_known_before_is_weighed_by_its_sigma(runs):
    pair = [runs["n"], runs["r"]]
    free = ratio_by_levels(CAR, pair, SURE, Value(0.0, 10.0))
    ratio = ratio_by_levels(CAR, pair, SURE, Value(0.1, 0.02))
    weights = np.array([0.02**-2.0, free.sigma**-2.0])
    assert ratio.value == pytest.approx(weights @ (0.1, free.value) / weights.sum(), abs=2e-3)
    assert ratio.sigma == pytest.approx(weights.sum() ** -0.5, rel=0.02)
