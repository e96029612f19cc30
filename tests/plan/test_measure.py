"""Runs of a plan: they end where they say, and those that cannot be driven are refused."""

import numpy as np
import pytest

from calib.base.errors import ModelError
from calib.car.model import default_model
from calib.plan.measure import HOLD, LEAD_IN, Track, drive, measures, pressure_trace
from tests.support.reference_car import CAR

RUNS = {measure.name: measure for measure in measures()}
MODEL = default_model(CAR)
FAST = Track(speed=33.0)


@pytest.mark.parametrize("name", ["ramp_35_4", "ramp_45_3", "ramp_60_3", "ramp_60_5"])
def test_a_ramp_ends_at_its_deceleration(name):
    log = drive(MODEL, RUNS[name], FAST, frozenset())
    top = np.abs(log.time - LEAD_IN - RUNS[name].rise - 0.5 * HOLD).argmin()
    # the inertia of the wheels takes some per cent of the brake force, (1)
    assert -log["a_x"][top] / 9.80665 == pytest.approx(RUNS[name].end, rel=0.06)


def test_one_axle_alone_uses_its_share_of_its_load():
    run = RUNS["rear_alone"]
    sensors = frozenset(f"p_{w}" for w in ("fl", "fr", "rl", "rr"))
    log = drive(MODEL, run, FAST, sensors)
    assert np.max(log["p_fl"]) == 0.0
    torque = 2.0 * np.max(log.truth["true_Tb_rl"])
    load = CAR.mass * 9.80665 * CAR.cg_to_front_axle / (CAR.cg_to_front_axle + CAR.cg_to_rear_axle)
    assert torque / CAR.rear.rolling_radius / load == pytest.approx(run.end, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "track"),
    [("ramp_60_5", Track(speed=20.0)), ("ramp_60_3", Track(80.0, 33.0)), ("rear_alone", FAST)],
    ids=["too slow", "too short", "no wheel pressures"],
)
def test_what_cannot_be_driven_is_refused(name, track):
    with pytest.raises(ModelError):
        drive(MODEL, RUNS[name], track, frozenset({"v"}))


@pytest.mark.parametrize("sensors", [set(), {"v"}], ids=["none", "v"])
def test_optional_channels_are_those_of_the_sensors(sensors):
    assert ("v" in drive(MODEL, RUNS["ramp_35_4"], FAST, frozenset(sensors))) == ("v" in sensors)


def test_a_robot_presses_from_rest_to_rest():
    time, pressure = pressure_trace(CAR, RUNS["ramp_60_3"])
    assert np.all(pressure[time <= LEAD_IN] == 0.0)
    assert pressure[-1] == 0.0
    assert np.max(np.abs(np.diff(pressure) / np.diff(time))) < 400e5  # as a master cylinder can
