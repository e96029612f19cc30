"""The pad ratio from a roller brake tester, against forces worked out by hand from T = mu C p."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import BenchError
from calib.car.effects.effects import Effects
from calib.model.roller_bench import AxleOnRollers, RollerBench
from tests.support.reference_car import CAR
from tests.support.refusals import refusal

PRESSURES = (8e5, 15e5, 25e5, 40e5)

PER_PA = {"front": 2 * 2 * 28.84e-4 * 0.1309 / 0.322, "rear": 2 * 2 * 11.34e-4 * 0.124 / 0.322}
"""Both wheels, two faces each, A r / R [m^2]: force of an axle over pressure and pad friction."""


def axle(name, mu, starts=0.0, pressures=PRESSURES, scale=1.0):
    """The rows of an axle with pads ``mu`` [1] that begins to brake at ``starts`` [Pa]."""
    force = tuple(scale * mu * PER_PA[name] * (p - starts) for p in pressures)
    return AxleOnRollers(pressures, force)


def bench(front, rear, tolerance=0.01):
    return RollerBench("bench", "bench.toml", "", tolerance, front, rear)


def test_exact_forces_give_the_pads_and_no_threshold_moves_them():
    """ln of 0.42/0.36 over the 1 of the file; one sigma of 1 %, of which half the variance is
    common: s^2 (1/2 + 1/2)."""
    rows = bench(axle("front", 0.42, 0.5e5), axle("rear", 0.36, -0.7e5))
    ratio = rows.log_pad_ratio(CAR)
    assert ratio.value == pytest.approx(math.log(0.42 / 0.36), abs=1e-9)
    assert ratio.sigma == pytest.approx(0.01, abs=1e-9)


@pytest.mark.parametrize("count", [3, 4, 8])
def test_intervals_hold_the_truth_as_often_as_they_say(count):
    """Scatter of each row, and machines of 2 %: the share of 95 % intervals, of 600 runs."""
    pressures = tuple(np.linspace(8e5, 40e5, count).tolist())
    rng, is_inside = np.random.default_rng(count), []
    for _ in range(600):
        common = rng.normal(0.0, 0.02 * math.sqrt(0.5))
        rows = []
        for name, mu in (("front", 0.40), ("rear", 0.37)):
            exact = axle(name, mu, 0.4e5, pressures)
            scale = math.exp(common + rng.normal(0.0, 0.02 * math.sqrt(0.5)))
            noise = rng.normal(0.0, 0.004 * max(exact.force), count)
            rows.append(AxleOnRollers(pressures, tuple(scale * np.array(exact.force) + noise)))
        ratio = bench(*rows, tolerance=0.02).log_pad_ratio(CAR)
        is_inside.append(abs(ratio.value - math.log(0.40 / 0.37)) < 1.96 * ratio.sigma)
    # with three rows Student's t has two degrees of freedom: the intervals are rather too wide
    assert 0.93 <= np.mean(is_inside) <= (0.98 if count > 3 else 1.0)


def test_a_valve_that_the_file_declares_is_taken_out():
    """Above 13.57 bar the rear pressure rises by a third, by hand: p_k + s (p - p_k)."""
    knee, slope = 13.57e5, 0.334
    limited = tuple(p if p < knee else knee + slope * (p - knee) for p in PRESSURES)
    rear = AxleOnRollers(PRESSURES, axle("rear", 0.36, pressures=limited).force)
    valve = {"rear_proportioning": {"knee": knee, "knee_slope": slope}}
    car = replace(CAR, effects=Effects(valve))
    ratio = bench(axle("front", 0.38), rear).log_pad_ratio(car)
    assert ratio.value == pytest.approx(math.log(0.38 / 0.36), abs=1e-9)


def test_rows_behind_a_valve_that_shuts_are_refused():
    valve = {"rear_proportioning": {"knee": 5e5, "knee_slope": 0.0}}
    rows = bench(axle("front", 0.38), axle("rear", 0.36))
    refusal(rows.log_pad_ratio, replace(CAR, effects=Effects(valve)), kind=BenchError, names="rear")


@pytest.mark.parametrize(
    "rear",
    [
        AxleOnRollers(PRESSURES, axle("rear", 0.36).force[::-1]),  # falls
        AxleOnRollers(PRESSURES, (500.0,) * 4),  # does not rise
        AxleOnRollers(PRESSURES, (300.0, 800.0, 850.0, 860.0)),  # the wheels slip
        axle("rear", 0.36, scale=1e-3),  # kN taken for N
        axle("rear", 1.2),
    ],
)
def test_rows_of_no_brake_are_refused(rear):
    rows = bench(axle("front", 0.38), rear)
    assert "rear" in refusal(rows.log_pad_ratio, CAR, kind=BenchError, names="bench.toml")
