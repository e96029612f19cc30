"""A log driven again: the same model gives the same run, and the first speed is found in noise."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.base.names import WHEELS
from calib.car.effects.effects import Effects
from calib.car.magic_formula import MagicFormula
from calib.car.model import default_model
from calib.car.vehicle_file import read_vehicle
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.model.manoeuvre import manoeuvre
from calib.model.replay import COAST_SECONDS, first_speed, replay
from calib.model.sensor_noise import add_noise
from calib.model.simulate import simulate
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, without

SAMPLES = Path(__file__).parents[2] / "sample_logs/sedan"
SEDAN = read_vehicle(SAMPLES / "vehicle.toml")
MODEL = replace(
    default_model(SEDAN),
    effects=Effects(
        {
            "aerodynamic_drag": {"drag_area": 0.66},
            "rolling_resistance": {"coefficient": 0.011},
        }
    ),
)


WHEEL_SPEEDS = tuple(f"omega_{w}" for w in WHEELS)


@pytest.fixture(scope="module")
def driven():
    plan = manoeuvre("ramp", 30.0)
    return simulate(MODEL, plan.time, plan.pressure, plan.v0, name="driven")


def test_a_simulated_log_replayed_by_its_model_is_itself(driven):
    again = replay(MODEL, driven)
    assert again.name == "driven"
    assert np.array_equal(again.time, driven.time)
    for channel in ("a_x", "v", *WHEEL_SPEEDS):
        # the first speed is met to 1 mm/s, and a wheel has a radius of 0.3 m
        bound = 1e-3 / 0.3 if channel in WHEEL_SPEEDS else 1e-3
        assert again[channel] == pytest.approx(driven[channel], abs=bound)


def test_pressures_of_single_wheels_are_used(driven):
    own = {f"p_{w}": driven["p_mc"] * (0.9 if w == "rl" else 1.0) for w in WHEELS}
    again = replay(MODEL, replace(driven, channels={**driven.channels, **own}))
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


def test_a_logged_motor_is_no_gap():
    """A plant of its own brakes with 200 N m at the front wheels; without the channel it slows."""
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


def test_a_logged_motor_and_engine_drag_are_both_counted(driven):
    drag = replace(
        MODEL, effects=MODEL.effects.with_(Effects({"engine_drag": {"drag_torque": 90.0}}))
    )
    log = replace(
        driven, channels={**driven.channels, "T_drive_f": np.full(driven.time.size, -60.0)}
    )
    whole = replace(
        MODEL, effects=MODEL.effects.with_(Effects({"engine_drag": {"drag_torque": 150.0}}))
    )
    both, once = replay(drag, log), replay(whole, driven)
    n = min(both.time.size, once.time.size)
    assert both["v"][:n] == pytest.approx(once["v"][:n], abs=1e-9)


def test_without_v_the_radii_of_the_model_count(driven):
    worn = replace(MODEL, effects=Effects({"rolling_radius_mismatch": {"radius_mismatch": -0.02}}))
    log = without(simulate(worn, driven.time, driven["p_mc"], 30.0), "v")
    assert replay(worn, log)["v"][0] == pytest.approx(30.0, rel=1e-3)
    assert replay(MODEL, log)["v"][0] == pytest.approx(30.3, rel=1e-3)


def test_first_speed_is_that_of_v(driven):
    assert first_speed(driven, SEDAN) == pytest.approx(30.0, abs=1e-3)
    found = [first_speed(add_noise(driven, seed), SEDAN) for seed in range(50)]
    # A line through n samples of white noise gives its end with sd 2 sigma/sqrt(n).
    sd = 2.0 * 0.02 / np.sqrt(COAST_SECONDS * 200)
    assert np.std(found) == pytest.approx(sd, rel=0.5)
    assert np.mean(found) == pytest.approx(30.0, abs=5.0 * sd / np.sqrt(50))


def test_a_log_without_speed_is_refused(driven):
    bare = without(driven, "v", *(f"omega_{w}" for w in WHEELS))
    with pytest.raises(LogError, match="no speed"):
        first_speed(bare, SEDAN)
    late = np.where(driven.time < 1.0, np.nan, driven["v"])
    with pytest.raises(LogError, match="no speed"):
        first_speed(replace(driven, channels={**driven.channels, "v": late}), SEDAN)


def test_a_measured_ramp_is_met_by_the_known_model():
    """Typical drag and rolling resistance explain the unbraked seconds, nominal pads the ramp."""
    log: Log = read_log(SAMPLES / "ramp_wet_asphalt.csv")
    again = replay(MODEL, log)
    n = again.time.size
    coasting = log["p_mc"][:n] < 0.5e5
    assert np.mean(again["a_x"][coasting]) == pytest.approx(
        np.mean(log["a_x"][:n][coasting]), abs=0.05
    )
    assert np.corrcoef(again["a_x"], log["a_x"][:n])[0, 1] > 0.99


def test_a_ripple_follows_the_angle_of_the_wheels_that_is_given(driven):
    """T_b = (2) (1 + a sin(angle + phase)), at any angle that is given."""
    ripple = {"amplitude": 0.1, "phase": 0.4, "side": 1.0}
    judder = replace(
        MODEL, effects=MODEL.effects.with_(Effects({"disc_thickness_variation": ripple}))
    )
    angle = 2.0 + 90.0 * (driven.time - driven.time[0])
    again = replay(judder, driven, wheel_angle={"f": angle})
    n = again.time.size
    even = SEDAN.front.pad_friction * SEDAN.front.torque_gain * again["p_mc"]
    assert again.truth["true_Tb_fl"] == pytest.approx(even * (1.0 + 0.1 * np.sin(angle[:n] + 0.4)))
    assert again.truth["true_Tb_fr"] == pytest.approx(even)
