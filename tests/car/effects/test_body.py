"""Effects of body and sensors against figures worked out by hand and filters of SciPy."""

import numpy as np
import pytest
from scipy.signal import butter, lsim

from calib.base.names import WHEELS, G
from calib.car.effects.body import AERODYNAMIC_DRAG, AIR_DENSITY
from calib.car.effects.catalogue import CATALOGUE
from calib.car.forces import axle_loads
from tests.support.effect_runs import (
    SEDAN,
    driven,
    made_history,
    made_motion,
    wave,
    without_inertia,
)

PITCH = CATALOGUE["pitch_coupling"]
MODE = {
    "elastic_share": 1.0,
    "natural_frequency": 2.0 * np.pi * 1.5,
    "damping": 0.25,
    "pitch_gradient": 0.03,
}
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
NO_EFFECT = driven({}, wave)


def drag(v, area=0.66):
    return AERODYNAMIC_DRAG.body_force(SEDAN, {"drag_area": area}, made_motion(np.atleast_1d(v)))


def test_306_newtons_at_100_km_h():
    assert drag(100.0 / 3.6) == pytest.approx(0.5 * 1.2 * 0.66 * 771.605, rel=1e-6)
    assert pytest.approx(101325.0 / (287.05 * 293.15), rel=0.005) == AIR_DENSITY  # gas law


def test_at_the_height_of_the_centre_of_gravity_only_tyre_forces_move_load():
    """The truth is the sum of moments about the rear contact: F_zf L = W l_r + F_x h."""
    effects = {"aerodynamic_drag": {"drag_area": 2.0, "load_share": 0.0}}
    run = driven(effects, lambda t: 10e5 * min(t, 1.0), 40.0, duration=2.0)
    F_x = sum(run.truth[f"true_Fx_{w}"] for w in WHEELS)
    moment = SEDAN.weight * SEDAN.cg_to_rear_axle + F_x * SEDAN.cg_height
    F_zf = run.truth["true_Fz_fl"] + run.truth["true_Fz_fr"]
    assert F_zf == pytest.approx(moment / SEDAN.wheelbase, rel=1e-6)
    assert np.all(axle_loads(SEDAN, -run["a_x"] / G)[0] > 1.01 * F_zf)


@pytest.mark.parametrize("grade", [0.04, -0.03])
@pytest.mark.parametrize("felt", [0.0, 1.0])
def test_a_car_left_alone_rolls_as_on_an_inclined_plane(grade, felt):
    effects = {"road_grade": {"grade": grade, "felt": felt}}
    log = driven(effects, lambda t: 0.0, 20.0, car=without_inertia(SEDAN))
    # an accelerometer that feels gravity reads nothing in free rolling
    assert log["a_x"] == pytest.approx((felt - 1.0) * G * grade, abs=1e-9)
    assert log["v"] == pytest.approx(20.0 - G * grade * log.time)
    assert log.truth["true_Fx_fl"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("rate", [40.0, 200.0])
@pytest.mark.parametrize(("frequency", "damping"), [(6.0, 0.1), (10.0, 0.3), (6.0, 0.7)])
def test_the_load_lags_as_the_mode_in_continuous_time(frequency, damping, rate):
    """The truth is h/L (z - z_b), with z_b by SciPy for a z that is linear between samples."""
    time = np.arange(round(5.0 * rate)) / rate
    z = 0.02 + 0.3 * np.clip((time - 1.0) / 0.25, 0.0, 1.0)
    mode = ([frequency**2], [1.0, 2.0 * damping * frequency, frequency**2])
    z_b = z[0] + lsim(mode, z - z[0], time)[1]
    expected = (z - z_b) * SEDAN.cg_height / SEDAN.wheelbase
    parameters = {**MODE, "natural_frequency": frequency, "damping": damping}
    shift = PITCH.load_shift(SEDAN, parameters, made_history(time.size, time=time, z=z))
    assert np.max(np.abs(shift - expected)) < 1e-9
    assert np.max(np.abs(expected)) > 0.01


def test_after_a_step_the_elastic_load_transfer_is_missing():
    history = made_history(3, time=np.array([0.0, 1e-6, 2e-6]), z=np.array([0.0, 0.4, 0.4]))
    shift = PITCH.load_shift(SEDAN, {**MODE, "elastic_share": 0.7}, history)
    assert shift[1:] == pytest.approx(0.7 * 0.4 * SEDAN.cg_height / SEDAN.wheelbase, rel=1e-6)


@pytest.mark.parametrize("name", SENSORS)
def test_an_effect_of_a_sensor_changes_its_reading_alone(name):
    parameters, changed = SENSORS[name]
    log = driven({name: parameters}, wave)
    for channel in ("a_x", "v", *OMEGA):
        assert np.array_equal(log[channel], NO_EFFECT[channel]) == (channel not in changed)
    assert np.array_equal(log.truth["true_Fz_fl"], NO_EFFECT.truth["true_Fz_fl"])


def test_the_scale_is_of_what_is_sensed_and_not_of_the_bias():
    bias, scale = {"bias": 0.5}, {"scale_error": 0.1}
    log = driven({"accelerometer_bias": bias, "accelerometer_scale": scale}, wave)
    assert log["a_x"] == pytest.approx(1.1 * NO_EFFECT["a_x"] + 0.5)
    in_other_order = driven({"accelerometer_scale": scale, "accelerometer_bias": bias}, wave)
    assert np.array_equal(log["a_x"], in_other_order["a_x"])


@pytest.mark.parametrize("name", ["speed_delay", "wheel_speed_delay"])
def test_a_delayed_reading_is_that_of_an_earlier_time(name):
    parameters, channels = SENSORS[name]
    (delay,) = parameters.values()
    log, n = driven({name: parameters}, wave), round(delay * 200)
    for channel in channels:
        assert log[channel][n:] == pytest.approx(NO_EFFECT[channel][:-n], abs=1e-9)


def test_a_bend_of_one_half_is_the_filter_of_butterworth():
    """A filter of second order with its corner at 3 Hz equals SciPy's analogue filter."""
    step = lambda t: 25e5 * (t > 1.0)  # noqa: E731
    corner = 2.0 * np.pi * 3.0
    parameters = {"filter_time": np.sqrt(2.0) / corner, "filter_bend": 0.5}
    filtered = driven({"accelerometer_lag": parameters}, step)
    exact = driven({}, step)
    start = exact["a_x"][0]
    _, expected, _ = lsim(butter(2, corner, analog=True), exact["a_x"] - start, exact.time)
    assert filtered["a_x"] == pytest.approx(start + expected, abs=0.01)


def test_a_runout_is_the_ripple_of_an_eccentric_ring():
    """A ring off centre by e/r = 0.002 has 1 - e/r sin of the speed of a centred ring."""
    motion = made_motion(np.full(50, 20.0))
    centre = -0.002j * np.exp(1j * (motion.history.angle_f + 0.3))  # in radii of the ring
    lever = np.abs(1.0 + 0.0j - centre)  # of the teeth under the sensor
    speed_factors = CATALOGUE["tone_ring_runout"].wheel_speed(SEDAN, RUNOUT, motion)
    assert speed_factors["fl"] == pytest.approx(lever, abs=2e-5)
    assert np.array_equal(speed_factors["fr"], np.ones(50))
