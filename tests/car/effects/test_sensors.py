"""Sensors: the reading is off as its equation says, the car is not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, lsim

from calib.base.names import WHEELS
from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.effects import Effects
from calib.car.lag import delayed
from calib.run.known_effects import remove_known_effects
from tests.support.effect_runs import SEDAN, driven, made_motion, wave

RUNOUT = {"runout": 0.002, "runout_phase": 0.3, "runout_side": 1.0}
OMEGA = tuple(f"omega_{w}" for w in WHEELS)
SENSORS = {
    "accelerometer_bias": ({"bias": -0.1}, ("a_x",)),
    "accelerometer_scale": ({"scale_error": 0.05}, ("a_x",)),
    "accelerometer_lag": ({"filter_time": 0.05}, ("a_x",)),
    "speed_delay": ({"v_delay": 0.13}, ("v",)),
    "wheel_speed_delay": ({"omega_delay": 0.04}, OMEGA),
    "tone_ring_runout": (RUNOUT, ("omega_fl",)),
}
RIGHT = driven({}, wave)


@pytest.mark.parametrize("name", SENSORS)
def test_only_its_own_reading_is_off(name):
    parameters, own = SENSORS[name]
    log = driven({name: parameters}, wave)
    for channel in ("a_x", "v", *OMEGA):
        assert np.array_equal(log[channel], RIGHT[channel]) == (channel not in own)
    assert np.array_equal(log.truth["true_Fz_fl"], RIGHT.truth["true_Fz_fl"])


def test_the_scale_is_of_what_is_sensed_and_not_of_the_bias():
    bias, scale = {"bias": 0.5}, {"scale_error": 0.1}
    one = driven({"accelerometer_bias": bias, "accelerometer_scale": scale}, wave)
    assert one["a_x"] == pytest.approx(1.1 * RIGHT["a_x"] + 0.5)
    other = driven({"accelerometer_scale": scale, "accelerometer_bias": bias}, wave)
    assert np.array_equal(one["a_x"], other["a_x"])


@pytest.mark.parametrize("name", ["speed_delay", "wheel_speed_delay"])
def test_a_delayed_reading_is_that_of_an_earlier_time(name):
    parameters, channels = SENSORS[name]
    (late,) = parameters.values()
    log, n = driven({name: parameters}, wave), round(late * 200)
    for channel in channels:
        assert log[channel][n:] == pytest.approx(RIGHT[channel][:-n], abs=1e-9)


def test_before_the_first_sample_the_line_of_the_first_two_goes_on():
    time = np.array([1.0, 1.5, 2.5])
    assert delayed(time, np.array([4.0, 3.0, 0.0]), 0.75) == pytest.approx([5.5, 4.5, 2.25])


def test_a_bend_of_one_half_is_the_filter_of_butterworth():
    """Second order with its corner at 3 Hz, against SciPy's analogue filter."""
    step = lambda t: 25e5 * (t > 1.0)  # noqa: E731
    corner = 2.0 * np.pi * 3.0
    filtered = {"filter_time": np.sqrt(2.0) / corner, "filter_bend": 0.5}
    late = driven({"accelerometer_lag": filtered}, step)
    right = driven({}, step)
    start = right["a_x"][0]
    _, expected, _ = lsim(butter(2, corner, analog=True), right["a_x"] - start, right.time)
    assert late["a_x"] == pytest.approx(start + expected, abs=0.01)


def test_a_runout_is_the_ripple_of_an_eccentric_ring():
    """Speed of the teeth past the sensor over that of a centred ring, e/r = 0.002: 1 - e/r sin."""
    motion = made_motion(np.full(50, 20.0))
    centre = -0.002j * np.exp(1j * (motion.history.angle_f + 0.3))  # in radii of the ring
    lever = np.abs(1.0 + 0.0j - centre)  # of the teeth under the sensor
    found = CATALOGUE["tone_ring_runout"].wheel_speed(SEDAN, RUNOUT, motion)
    assert found["fl"] == pytest.approx(lever, abs=2e-5)
    assert np.array_equal(found["fr"], np.ones(50))


@pytest.mark.parametrize(
    ("side", "left", "right"), [(0.0, 1.0, 1.0), (1.0, 1.0, 0.0), (-0.5, 0.5, 1)]
)
def test_one_ring_or_two(side, left, right):
    motion = made_motion(np.full(50, 20.0))
    given = {**RUNOUT, "runout_side": side}
    found = CATALOGUE["tone_ring_runout"].wheel_speed(SEDAN, given, motion)
    turned = 0.002 * np.sin(motion.history.angle_f + 0.3)
    assert 1.0 - found["fl"] == pytest.approx(left * turned)
    assert 1.0 - found["fr"] == pytest.approx(right * turned)


def test_the_analysis_takes_a_runout_out():
    """The angle comes from the readings, so it is off by at most the runout."""
    effects = {"tone_ring_runout": RUNOUT}
    bare, off = driven({}), driven(effects)
    clean = remove_known_effects(replace(SEDAN, effects=Effects(effects)), off)
    assert clean.log["omega_fl"] == pytest.approx(bare["omega_fl"], rel=1e-5)
