"""Sensors with a known resolution, noise and defect."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import WHEEL_SPEEDS
from calib.run.driving_record import driving_record
from calib.run.sensors import _saturation, resolution_of, sensors_of
from tests.support.made_runs import changed, made_run, ramp, stop


def sensors(log):
    return sensors_of(log, driving_record(log))


def sensor(log, channel):
    return next(s for s in sensors(log) if s.channel == channel)


def stuck(log):
    return {s.channel: s.stuck for s in sensors(log) if s.stuck}


@pytest.mark.parametrize("step", [0.005, 0.1, 6103.5])
def test_resolution_of_rounded_values(step):
    x = np.random.default_rng(1).normal(size=500) * 20 * step
    assert resolution_of(np.round(x / step) * step) == pytest.approx(step, rel=1e-6)


def test_no_resolution_in_smooth_values_and_in_a_channel_that_was_interpolated():
    assert resolution_of(np.random.default_rng(1).normal(size=500)) == 0.0
    assert resolution_of(np.zeros(100)) == 0.0
    log = made_run()
    coarse = changed(log, p_mc=np.round(log["p_mc"] / 1e5) * 1e5)
    assert sensor(coarse, "p_mc").resolution == pytest.approx(1e5)
    assert sensor(replace(coarse, interpolated=("p_mc",)), "p_mc").resolution == 0.0


def test_saturated_value_is_held_as_no_other_is():
    x = np.random.default_rng(5).normal(size=2000) + 10 * np.sin(np.arange(2000) / 200)
    assert _saturation(x, 0.005) == 0.0
    assert _saturation(np.minimum(x, 9.0), 0.005) == 0.0  # noise takes it off its limit again
    assert _saturation(np.minimum(x, 3.0), 0.005) > 1.0


@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("pressure", [ramp(), stop(), lambda t: 0.0 * t])
def test_sound_runs_have_no_stuck_sensor(noise, pressure):
    assert stuck(made_run(pressure, noise=noise)) == {}


@pytest.mark.parametrize("channel", ["omega_rr", "v", "a_x"])
def test_constant_sensor(channel):
    log = made_run(stop(end=5.0))
    constant = np.full(log.time.size, log[channel][0])
    assert set(stuck(changed(log, **{channel: constant}))) == {channel}


@pytest.mark.parametrize("channel", ["omega_fl", "a_x", "p_mc"])
def test_sensor_that_hangs_for_a_while(channel):
    log = made_run(ramp(rate=12.0))
    values = log[channel].copy()
    values[400:700] = values[400]
    ((start, end),) = stuck(changed(log, **{channel: values}))[channel]
    assert start == pytest.approx(2.0, abs=0.01)
    assert end == pytest.approx(3.5, abs=0.01)


def test_wheels_that_stand_are_not_stuck_though_each_stops_at_another_sample():
    """A brake control unit shows 0 below 1 m/s: the others still turn, for some samples."""
    log = made_run(stop(end=20.0), duration=14.0)
    stands = int(np.argmax(log["v"] < 1.0))
    assert 0 < stands < log.time.size - 300
    wheels = {}
    for i, name in enumerate(WHEEL_SPEEDS):
        turning = np.maximum(log[name], 1.0 / 0.32)
        wheels[name] = np.where(np.arange(log.time.size) < stands + 3 * i, turning, 0.0)
    assert stuck(changed(log, **wheels)) == {}


def test_a_motor_back_at_rest_is_not_saturation():
    log = made_run(stop())
    share = np.clip((log.time - 1.0) / log.time[-1], 0.0, 0.3)
    regenerating = -200.0 * share * (0.3 - share) + np.sin(40.0 * share) * (share - 0.3)
    torque = np.minimum(regenerating, 0.0)
    assert _saturation(torque, log.sample_time) > 1.0
    log = changed(log, T_drive_r=torque)
    assert sensor(log, "T_drive_r").saturated == 0.0


def test_a_pressure_that_is_held_is_not_stuck():
    """Pads that are held at 40 bar lose half of their friction: that is no fault of p_mc."""
    log = made_run(lambda t: np.clip(30.0 * (t - 1.5), 0.0, 40.0), duration=6.0, noise=0.0)
    share = np.interp(log.time, [3.0, 4.0], [1.0, 0.5])
    speed = np.maximum(30.0 + np.cumsum(share * log["a_x"]) / 200.0, 1.0)
    wheels = dict.fromkeys(WHEEL_SPEEDS, speed / 0.32)
    quantised = np.round(log["p_mc"] / 0.5e5) * 0.5e5
    log = changed(log, a_x=share * log["a_x"], v=speed, p_mc=quantised, **wheels)
    assert "p_mc" not in stuck(log)


def test_a_pressure_that_is_held_is_not_at_the_end_of_its_range():
    log = made_run(lambda t: np.clip(40.0 * (t - 0.3), 0.0, 40.0), duration=6.0)
    rounded = changed(log, p_mc=np.round(log["p_mc"] / 1e5) * 1e5)
    assert _saturation(rounded["p_mc"], 0.005) > 1.0  # by its values alone it could be
    assert sensor(rounded, "p_mc").saturated == 0.0


def test_a_pressure_beyond_its_range_is_at_its_end():
    log = made_run(ramp(start=0.5, rate=10.0, top=60.0))
    beyond = changed(log, p_mc=np.minimum(log["p_mc"], 30e5))
    assert sensor(beyond, "p_mc").saturated > 1.0


@pytest.mark.parametrize("value", [30e5, 55e5])
def test_a_pressure_that_hangs_to_the_end_is_stuck(value):
    """It was released, or never applied, and does not say so."""
    log = made_run(stop(start=1.5, end=4.0))
    hanging = np.where(log.time > 2.0, value, log["p_mc"])
    assert "p_mc" in stuck(changed(log, p_mc=hanging))


@pytest.mark.parametrize("rate", [40.0, 200.0])
def test_a_pressure_without_its_noise_is_stuck(rate):
    """From 2 s to the end, while the driver lets go by two thirds: nothing is released."""
    log = made_run(lambda t: np.interp(t, [1.0, 1.5, 3.5, 4.0], [0, 25, 25, 8]), rate=rate)
    assert "p_mc" not in stuck(log)
    hanging = np.where(log.time > 2.0, log["p_mc"][log.time > 2.0][0], log["p_mc"])
    ((start, end),) = stuck(changed(log, p_mc=hanging))["p_mc"]
    assert start == pytest.approx(2.0, abs=0.05)
    assert end == pytest.approx(log.time[-1])


def test_noise_of_coarse_values_is_that_of_the_sensor():
    log = made_run(noise=0.0)
    noise = np.random.default_rng(5).normal(0.0, 0.1e5, log.time.size)
    coarse = changed(log, p_mc=np.round((log["p_mc"] + noise) / 0.05e5) * 0.05e5)
    assert sensor(coarse, "p_mc").noise == pytest.approx(0.1e5, rel=0.15)
