"""Swapped axles leave nothing valid, weak front pads are estimated; by the independent plant."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.warning import RULES, VOID
from calib.car.balance import pressure_per_g
from calib.estimation.estimator import estimate
from calib.estimation.validate import validate
from calib.estimation.warnings import axles_exchanged
from calib.fitting.fit import fit
from calib.plausibility.check import check
from tests.support.plant import Plant, as_log, drive, magic
from tests.support.reference_car import (
    CAR,
    REAL,
    WET,
    balanced,
    covered,
    noisy,
    one_axle,
    ramp,
    stop,
    swapped,
    with_pads,
    without,
)

(VOID_ODDS,) = (x.high for x in RULES if (x.code, x.consequence) == ("axles_exchanged", VOID))

SOFT = replace(REAL, tyre=magic(15.0, 0.6))
"""The car on a road where its tyres are softer."""


def odds(table, log):
    return axles_exchanged(table, estimate(table, log))


def weak(plant, share, seed=3):
    """A whole stop with front pads of ``share`` of their friction on the ramp."""
    pads = share * CAR.front.pad_friction, CAR.rear.pad_friction
    return noisy(stop(with_pads(plant, *pads), duration=20.0), seed)


def test_swapped_axles_leave_nothing_valid_with_a_reference_speed_and_without(fitted):
    log = swapped(noisy(stop(WET), 0))
    for result in validate(fitted, [log, without(log, "v")]):
        assert not result.passed
        assert not result.estimate.valid.any()
        (warning,) = (w for w in result.warnings if w.code == "axles_exchanged")
        assert "swapped" in warning.causes[0]


def test_weak_front_pads_are_estimated(fitted):
    log = weak(REAL, 0.7)
    (result,) = validate(fitted, [log])
    assert result.figures["valid_share"] > 0.75
    assert min(covered(result.estimate, 0.7, 1.0, "change")) > 0.9
    (warning,) = (w for w in result.warnings if w.code == "pads_changed_apart")
    assert any("swapped" in cause for cause in warning.causes)
    verdicts = {v.purpose: v.usable for v in check(log).verdicts}
    assert verdicts["validate"]


def test_where_eta_falls_as_far_as_with_swapped_axles_the_pads_are_not_refused(fitted):
    """Front pads at half their friction on a soft road; a sure answer would be a wrong one."""
    assert odds(fitted, weak(SOFT, 0.5)) < VOID_ODDS


@pytest.mark.parametrize(("front", "rear"), [(0.22, 0.37), (0.38, 0.28)])
def test_pads_that_fade_unequally_are_not_taken_for_swapped(fitted, front, rear):
    """Front pads at 0.6 of the rear ones bring eta below one, by a third of the table's rise."""
    assert odds(fitted, noisy(stop(with_pads(REAL, front, rear)), 0)) < 0.0


def test_a_stop_with_the_rear_axle_only_is_not_taken_for_swapped(fitted):
    """Its eta falls by as much as that of a normal stop rises; its wheel pressures say why."""
    log = noisy(one_axle(REAL, "r"), 0)
    assert odds(fitted, log) == 0.0
    assert odds(fitted, without(log, *(f"p_{a}{s}" for a in "fr" for s in "lr"))) > 0.0


def test_abs_on_the_rear_axle_is_not_taken_for_swapped(fitted):
    log = noisy(stop(WET), 3)
    cycle = (log.time > 2.5) & ((log.time * 4.0) % 1.0 < 0.4)
    hit = {f"omega_r{s}": np.where(cycle, 0.7, 1.0) * log[f"omega_r{s}"] for s in "lr"}
    assert odds(fitted, replace(log, channels={**log.channels, **hit})) < 0.0


NEAR = balanced(CAR, 0.42)
"""Eta of the car rises by 0.1 % at most, and is 1 again at 0.42 g."""


@pytest.mark.parametrize(("z", "logged"), [(0.4, "with v"), (0.2, "without v")])
def test_near_ideal_balance_a_stop_says_which_axle_is_which(near, z, logged):
    log = noisy(stop(replace(REAL, vehicle=NEAR), z * pressure_per_g(NEAR)), 5)
    log = log if logged == "with v" else without(log, "v")
    assert odds(near, log) < -VOID_ODDS
    assert odds(near, swapped(log)) > VOID_ODDS


@pytest.fixture(scope="module")
def near():
    plant = replace(REAL, vehicle=NEAR)
    return fit(NEAR, [noisy(ramp(plant, 0.07 * pressure_per_g(NEAR)), 1)])


def test_weak_pads_on_a_road_with_more_grip_than_that_of_the_ramp_are_no_swap():
    """Exchanged, the pads would be three times apart; as it is they are those of the ramp."""
    car = balanced(CAR, 0.6)
    plant = Plant(car, tyre=magic(25.0, 0.95), drag_area=0.66, rolling_resistance=0.011)
    slippery = replace(plant, surface=lambda x: (0.65, 0.55))
    weak = replace(plant, pads=lambda t: (0.19, 0.19))
    rising = drive(slippery, lambda t: 5e5 * max(t - 1.5, 0.0), 33.0, duration=8.5, stop_speed=8.0)
    light = drive(
        weak, lambda t: 5e5 * min(max((t - 1.5) / 0.25, 0.0), 1.0), 42.0, duration=30.0,
        stop_speed=3.0,
    )  # fmt: skip
    coast = drive(plant, lambda t: 0.0, 33.0, duration=12.0)
    runs = [as_log(run, name) for run, name in ((rising, "ramp"), (coast, "coast"))]
    table = fit(car, [noisy(log, seed) for seed, log in enumerate(runs, 1)])
    log = noisy(as_log(light, "light"), 3)
    assert odds(table, log) <= 0.0
