"""A log driven again: the same model gives the same run, and the first speed is found in noise."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import LogError, ModelError
from calib.base.names import WHEEL_SPEEDS, WHEELS
from calib.car.effects.effects import Effects
from calib.car.model import default_model
from calib.car.tyre import MagicFormula
from calib.car.vehicle_file import read_vehicle
from calib.logs.read import read_log
from calib.model.manoeuvre import manoeuvre
from calib.model.sensor_noise import add_noise
from calib.model.simulate import COAST_SECONDS, STEP, fine_clock, first_speed, replay, simulate
from tests.support.plant import Plant, as_log, drive, magic
from tests.support.reference_car import CAR, REAL, without

SAMPLES = Path(__file__).parents[2] / "sample_logs/sedan"
SEDAN = read_vehicle(SAMPLES / "vehicle.toml")
MODEL = replace(
    default_model(SEDAN),
    effects=Effects(
        {"aerodynamic_drag": {"drag_area": 0.66}, "rolling_resistance": {"coefficient": 0.011}}
    ),
)


@pytest.fixture(scope="module")
def driven():
    return simulate(MODEL, *manoeuvre("ramp"), 30.0, name="driven")


def test_a_simulated_log_replayed_by_its_model_is_itself(driven):
    again = replay(MODEL, driven)
    assert again.name == "driven"
    assert np.array_equal(again.time, driven.time)
    for channel in ("a_x", "v", *WHEEL_SPEEDS):
        # the first speed is met to 1 mm/s, and a wheel has a radius of 0.3 m
        bound = 1e-3 / 0.3 if channel in WHEEL_SPEEDS else 1e-3
        assert again[channel] == pytest.approx(driven[channel], abs=bound)


def test_pressures_of_single_wheels_are_used(driven):
    pressures = {f"p_{w}": driven["p_mc"] * (0.9 if w == "rl" else 1.0) for w in WHEELS}
    again = replay(MODEL, replace(driven, channels={**driven.channels, **pressures}))
    late = slice(driven.time.size // 2, None)
    ratio = again.truth["true_Tb_rl"][late] / again.truth["true_Tb_rr"][late]
    assert ratio == pytest.approx(0.9)


def test_disc_temperatures_are_used(driven):
    hot = {f"T_disc_{a}": np.full(driven.time.size, 350.0) for a in "fr"}
    fade = Effects({"pad_thermal_fade": {"fade_slope": 0.001, "fade_onset": 150.0}})
    again = replay(
        replace(MODEL, effects=MODEL.effects.with_(fade)),
        replace(driven, channels={**driven.channels, **hot}),
    )
    n = again.time.size
    assert again.truth["true_Tb_fl"] == pytest.approx(0.8 * driven.truth["true_Tb_fl"][:n])
    assert np.array_equal(again["T_disc_f"], hot["T_disc_f"][:n])


def test_a_logged_motor_torque_is_replayed():
    """A motor slows the plant by 200 N m in front; without its channel the replay is too fast."""
    plant = replace(REAL, motor=lambda t: (-200.0 * min(t, 1.0), 60.0))
    log = as_log(drive(plant, lambda t: 25e5 * min(max(t - 1.5, 0.0), 1.0), 27.0, stop_speed=3.0))
    model = replace(default_model(CAR), effects=MODEL.effects, tyre=MagicFormula(25.0, 0.9, 1.65))
    again = replay(model, log)
    n = again.time.size
    assert again["v"] == pytest.approx(log["v"][:n], abs=0.1)
    assert again["omega_fl"] == pytest.approx(log["omega_fl"][:n], abs=0.3)
    assert np.array_equal(again["T_drive_f"], log["T_drive_f"][:n])
    assert again.truth["true_Tb_fl"] == pytest.approx(
        log.truth["true_Tb_fl"][:n], rel=0.01, abs=2.0
    )
    alone = replay(model, without(log, "T_drive_f", "T_drive_r"))
    m = min(n, alone.time.size)
    assert np.max(alone["v"][:m] - log["v"][:m]) > 0.5


def test_without_v_the_radii_of_the_model_count(driven):
    worn = replace(MODEL, effects=Effects({"rolling_radius_mismatch": {"radius_mismatch": -0.02}}))
    log = without(simulate(worn, driven.time, driven["p_mc"], 30.0), "v")
    assert replay(worn, log)["v"][0] == pytest.approx(30.0, rel=1e-3)
    assert replay(MODEL, log)["v"][0] == pytest.approx(30.3, rel=1e-3)


def test_first_speed_is_that_of_v(driven):
    assert first_speed(driven, SEDAN) == pytest.approx(30.0, abs=1e-3)
    speeds = [first_speed(add_noise(driven, seed), SEDAN) for seed in range(50)]
    # A line through n samples of white noise gives its end with sd 2 sigma/sqrt(n).
    sd = 2.0 * 0.02 / np.sqrt(COAST_SECONDS * 200)
    assert np.std(speeds) == pytest.approx(sd, rel=0.5)
    assert np.mean(speeds) == pytest.approx(30.0, abs=5.0 * sd / np.sqrt(50))


def test_a_log_without_speed_is_refused(driven):
    bare = without(driven, "v", *WHEEL_SPEEDS)
    with pytest.raises(LogError, match="no speed"):
        first_speed(bare, SEDAN)
    late = np.where(driven.time < 1.0, np.nan, driven["v"])
    with pytest.raises(LogError, match="no speed"):
        first_speed(replace(driven, channels={**driven.channels, "v": late}), SEDAN)


def test_a_measured_ramp_is_met_by_the_known_model():
    """Typical drag and rolling resistance explain the unbraked seconds, nominal pads the ramp."""
    log = read_log(SAMPLES / "ramp_wet_asphalt.csv")
    again = replay(MODEL, log)
    n = again.time.size
    coasting = log["p_mc"][:n] < 0.5e5
    assert np.mean(again["a_x"][coasting]) == pytest.approx(
        np.mean(log["a_x"][:n][coasting]), abs=0.05
    )
    assert np.corrcoef(again["a_x"], log["a_x"][:n])[0, 1] > 0.99


PLANT = Plant(
    SEDAN, tyre=magic(25.0, 0.9, 1.65, 0.0, 0.1), drag_area=0.66, rolling_resistance=0.011
)
COARSE = 1.0 / 40.0
KNOWN = replace(MODEL, tyre=MagicFormula(25.0, 0.9, 1.65, 0.1))


def bends(t: float) -> float:
    """Pressure [Pa] whose corners lie on samples of 40 Hz, so that its samples tell all of it."""
    return float(
        np.interp(t, [0.0, 1.0, 1.2, 2.0, 2.2, 3.0, 3.1], [0, 0, 35e5, 35e5, 5e5, 5e5, 3e6])
    )


@given(st.lists(st.floats(1e-4, 0.1), min_size=1, max_size=40))
def test_every_sample_is_kept_and_no_step_is_longer(steps):
    time = np.concatenate([[3.0], 3.0 + np.cumsum(steps)])
    clock, samples = fine_clock(time)
    assert np.array_equal(clock[samples], time)
    assert np.max(np.diff(clock)) <= STEP * (1.0 + 1e-5)
    assert np.min(np.diff(clock)) > 0.0


@pytest.mark.parametrize("rate", [40, 200])
def test_the_rate_of_the_clock_does_not_count(rate):
    """Against a plant that is integrated stiffly; steps of the clock would cost up to 0.0024."""
    run = drive(PLANT, bends, 30.0, duration=5.0, rate=float(rate), rtol=1e-9)
    log = simulate(KNOWN, run["time"], np.array([bends(t) for t in run["time"]]), 30.0)
    assert log.time.size == run["time"].size
    assert np.max(np.abs(log["v"] - run["v"])) < 7e-4


def test_inputs_come_back_at_the_samples_they_were_given_at():
    time = np.arange(81) * COARSE
    p, T_disc = np.linspace(0.0, 20e5, 81), np.linspace(80.0, 120.0, 81)
    torque = np.full(81, -50.0)
    log = simulate(
        KNOWN,
        time,
        p,
        25.0,
        wheel_pressure={"fl": 0.9 * p},
        temperature={"f": T_disc},
        drive_torque={"f": torque},
    )
    inputs = {"time": time, "p_mc": p, "p_fl": 0.9 * p, "T_disc_f": T_disc, "T_drive_f": torque}
    for channel, values in inputs.items():
        assert np.array_equal(log[channel], values)
    assert all(x.shape == time.shape for x in log.truth.values())


def test_a_run_that_ends_within_the_second_step_of_the_clock_is_refused():
    with pytest.raises(ModelError, match="nothing to simulate") as refused:
        simulate(KNOWN, np.arange(5) * COARSE, np.full(5, 30e5), 1.1, stop_speed=1.0)
    assert "slower than 1 m/s" in str(refused.value)
