"""The solver's own steps: a coarse clock gives the run of a fine one, and that of the plant."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import ModelError
from calib.car.effects.effects import Effects
from calib.car.magic_formula import MagicFormula
from calib.car.model import Model, default_model
from calib.car.vehicle_file import read_vehicle
from calib.model.simulate import STEP, fine_clock, simulate
from tests.support.plant import Plant, drive, magic

SEDAN = read_vehicle(Path(__file__).parents[2] / "sample_logs/sedan/vehicle.toml")
KNOWN = {
    "aerodynamic_drag": {"drag_area": 0.66},
    "rolling_resistance": {"coefficient": 0.011},
}
PLANT = Plant(
    SEDAN, tyre=magic(25.0, 0.9, 1.65, 0.0, 0.1), drag_area=0.66, rolling_resistance=0.011
)
COARSE = 1.0 / 40.0


def model() -> Model:
    pads = default_model(SEDAN)
    tyre = MagicFormula(25.0, 0.9, 1.65, 0.1)
    return Model(
        SEDAN, pads.pad_friction_f, pads.pad_friction_r, tyre, Effects(KNOWN), pads.surfaces
    )


def bends(t: float) -> float:
    """Pressure [Pa] whose corners lie on samples of 40 Hz, so that its samples tell all of it."""
    return float(
        np.interp(t, [0.0, 1.0, 1.2, 2.0, 2.2, 3.0, 3.1], [0, 0, 35e5, 35e5, 5e5, 5e5, 3e6])
    )


@given(st.lists(st.floats(1e-4, 0.1), min_size=1, max_size=40))
def test_every_sample_is_kept_and_no_step_is_longer(steps):
    time = np.concatenate([[3.0], 3.0 + np.cumsum(steps)])
    clock = fine_clock(time)
    assert np.array_equal(clock.time[clock.at], time)
    assert np.max(np.diff(clock.time)) <= STEP * (1.0 + 1e-5)
    assert np.min(np.diff(clock.time)) > 0.0


def test_a_clock_that_is_fine_enough_is_not_changed():
    time = np.arange(2001) / 200.0
    clock = fine_clock(time)
    assert np.array_equal(clock.time, time)
    assert clock.along(time) is time


@pytest.mark.parametrize("rate", [40, 200])
def test_the_rate_of_the_clock_does_not_count(rate):
    """Against a plant that is integrated stiffly; steps of the clock would cost up to 0.0024."""
    run = drive(PLANT, bends, 30.0, duration=5.0, rate=float(rate), rtol=1e-9)
    log = simulate(model(), run["time"], np.array([bends(t) for t in run["time"]]), 30.0)
    assert log.time.size == run["time"].size
    assert np.max(np.abs(log["v"] - run["v"])) < 7e-4


def test_inputs_come_back_at_the_samples_they_were_given_at():
    time = np.arange(81) * COARSE
    p, heat = np.linspace(0.0, 20e5, 81), np.linspace(80.0, 120.0, 81)
    torque = np.full(81, -50.0)
    log = simulate(
        model(),
        time,
        p,
        25.0,
        wheel_pressure={"fl": 0.9 * p},
        temperature={"f": heat},
        drive_torque={"f": torque},
    )
    for channel, given_ in (("time", time), ("p_mc", p), ("p_fl", 0.9 * p), ("T_disc_f", heat)):
        assert np.array_equal(log[channel], given_)
    assert np.array_equal(log["T_drive_f"], torque)
    assert all(x.shape == time.shape for x in log.truth.values())


def test_a_run_that_ends_within_the_second_step_of_the_clock_is_refused():
    with pytest.raises(ModelError, match="nothing to simulate") as refused:
        simulate(model(), np.arange(5) * COARSE, np.full(5, 30e5), 1.1, stop_speed=1.0)
    assert "slower than 1 m/s" in str(refused.value)
