"""Errors of the torque on a plant with an effect, with the effect in the vehicle file and without.

The plant of the tests has its own load transfer, motor and drag, and no function of `calib`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, with_pads, without

MOTOR = 500.0
"""Torque of the motor at both front wheels [N m], a sixth of the brakes' at 25 bar."""

PLANTS = {
    "pitch_coupling": (
        {"pitch_frequency": 1.3, "pitch_damping": 0.3, "pitch_felt": 0.05},
        {"elastic_share": 1.0, "natural_frequency": 2.0 * math.pi * 1.3, "damping": 0.3,
         "pitch_gradient": 0.05},
    ),
    "engine_drag": (
        {"motor": lambda t: (-MOTOR, 0.0)},
        {"drag_torque": MOTOR},
    ),
    "regenerative_torque": (
        {"motor": lambda t: (-MOTOR * (t > 1.51), 0.0)},
        {"regen_torque": MOTOR, "regen_power": 2e5, "regen_rear_share": 0.0},
    ),
}  # fmt: skip


def waving(t):
    """Pressure [Pa] of a stop that goes up and down with the pitch of a body."""
    return 1e5 * min(max(4.0 * (t - 1.5), 0.0), 1.0) * (22.0 + 12.0 * math.sin(6.0 * (t - 1.75)))


def logs(plant):
    """Ramp, coast and stop with weak pads, as usual sensors give them; no motor is logged."""
    always = plant.motor if plant.motor and any(plant.motor(0.0)) else None
    runs = (
        drive(plant, lambda t: 5e5 * max(t - 1.5, 0.0), 33.0, duration=9.5, stop_speed=8.0),
        drive(replace(plant, motor=always), lambda t: 0.0, 33.0, duration=10.0, stop_speed=8.0),
        drive(with_pads(plant, 0.31, 0.27), waving, 27.0, duration=9.0, stop_speed=2.0),
    )
    noisy_logs = [noisy(as_log(run, f"run_{i}"), 40 + i) for i, run in enumerate(runs)]
    return [without(log, "T_drive_f", "T_drive_r") for log in noisy_logs]


def errors(table, log):
    """Mean of ln of the torque over the truth, half a second from the bite on, front and rear, of
    the best estimate and of the ECU's (2, 2)."""
    e = estimate(table, log)
    counted = (log["p_mc"] > 2e5) & (log.time > 2.1) & (log["v"] > 4.0)
    true = np.stack([log.truth[f"true_Tb_{axle}l"] for axle in "fr"])
    torques = np.array([[x.torque_f.value, x.torque_r.value] for x in (e.best, e.ecu)])
    return np.mean(np.log(torques[..., counted] / true[:, counted]), axis=-1)


@pytest.fixture(scope="module")
def plain():
    """Errors where there is no effect."""
    ramp, coast, stop = logs(REAL)
    return errors(fit(CAR, [ramp, coast]), stop)


@pytest.mark.parametrize("name", PLANTS)
def test_a_known_effect_is_in_the_fit_and_out_of_the_estimate(name, plain):
    """With the effect in the file, the errors are those of a plant without it. Without, they are
    larger, except for a moment that acts on the lead-in, too, which is zeroed."""
    truth, parameters = PLANTS[name]
    ramp, coast, stop = logs(replace(REAL, **truth))
    car = replace(CAR, effects=Effects({name: parameters}))
    table = fit(car, [ramp, coast])
    with_effect, without_effect = (
        errors(replace(table, vehicle=replace(table.vehicle, effects=effects)), stop) - plain
        for effects in (car.effects, Effects())
    )
    assert np.abs(with_effect).max() < 0.035
    if name != "engine_drag":
        assert np.all(np.abs(with_effect[:, 0]) < 0.5 * np.abs(without_effect[:, 0]))


def test_an_ecu_does_not_know_the_temperature_of_the_discs():
    """Pads at 0.31/0.27 lose a third as the discs get hot. With the fade in the file, the pads are
    those of cold discs. The torque of the ECU, which has no temperature, does not change."""
    heat = {"fade_slope": 1.2e-3, "fade_onset": 100.0}

    def degrees(t):
        return 100.0 + 40.0 * np.clip(t - 1.5, 0.0, 7.0)

    def fading(t):
        remaining = 1.0 - heat["fade_slope"] * (degrees(t) - 100.0)
        return 0.31 * remaining, 0.27 * remaining

    ramp, coast, _ = logs(REAL)
    hot = replace(with_pads(REAL, 0.31, 0.27), pads=fading)
    log = noisy(as_log(drive(hot, lambda t: 25e5 * (t > 1.5), 27.0, duration=7.0), "hot"), 9)
    discs = {f"T_disc_{axle}": degrees(log.time) for axle in "fr"}
    log = replace(log, channels={**without(log, "T_drive_f", "T_drive_r").channels, **discs})
    table = fit(CAR, [ramp, coast])
    fading_car = replace(CAR, effects=Effects({"pad_thermal_fade": heat}))
    with_fade = estimate(replace(table, vehicle=fading_car), log)
    without_fade = estimate(table, log)
    late = (log.time > 4.0) & (log["v"] > 4.0)
    assert np.abs(with_fade.best.pads_f.value[late] / 0.31 - 1.0).max() < 0.06
    assert np.array_equal(with_fade.ecu.torque_f.value, without_fade.ecu.torque_f.value)
    assert not np.array_equal(with_fade.best.torque_f.value, without_fade.best.torque_f.value)
    ratio = with_fade.ecu.pads_f.value[late] / 0.31
    assert np.abs(ratio - 1.0).max() < 0.06  # without the fade, as the best ones
