"""Delay and force without pressure, from forces that are made by the formula."""

import numpy as np
import pytest

from calib.car.balance import ForceBalance
from calib.car.lag import first_order
from calib.run.axle_signals import Signals
from calib.run.brake_response import BrakeBalance, brake_response

TIME = np.arange(0.0, 8.0, 0.005)
WEIGHT = 16000.0


def made_balance(demanded):
    """The balance of a car whose tyres carry ``demanded`` [N] (n,) and nothing else."""
    zero = np.zeros_like(demanded)
    return ForceBalance(zero + 9000.0, zero + 7000.0, zero, zero, zero, zero, zero, demanded)


def pedal(t):
    """Nominal brake force [N]: applied within 0.2 s at 1.5 s, waved, released at 6.5 s."""
    on = np.clip((t - 1.5) / 0.2, 0.0, 1.0) * np.clip((6.7 - t) / 0.2, 0.0, 1.0)
    return 5000.0 * on * (1.0 + 0.2 * np.sin(2.0 * t))


def run(demanded, *, seed=0, noise=0.005, speed=20.0):
    """The run and its forces; noise of z in g at 200 Hz."""
    noise_of_force = noise * WEIGHT * np.random.default_rng(seed).standard_normal(TIME.size)
    nominal = pedal(TIME)
    ones = np.ones_like(TIME)
    s = Signals(
        time=TIME, p_f=nominal * 1e3, p_r=nominal * 1e3, drive_f=0.0 * ones, drive_r=0.0 * ones,
        z=ones, omega_f=ones, omega_r=ones, v=None,
        speed=speed * ones, lead_in=TIME < 1.2, sample_time=0.005,
    )  # fmt: skip
    forces = BrakeBalance(
        nominal_f=0.7 * nominal,
        nominal_r=0.3 * nominal,
        balance=made_balance(demanded + noise_of_force),
        active=(nominal > 200.0),
    )
    return s, forces


def brake_force(level=0.8, force=0.0, lag=0.0, shift=0.0, fade=0.0, resistance=0.0):
    """Demanded brake force [N] with a force, lag or shift [s], fade [1/s], resistance [N]."""
    n = pedal(TIME - shift)
    n = first_order(TIME, n, lag) if lag else n
    return level * n * (1.0 - fade * TIME) + force * (pedal(TIME - shift) > 200.0) + resistance


@pytest.mark.parametrize("seed", range(2))
def test_brakes_that_only_follow_the_pressure(seed):
    response = brake_response(*run(brake_force(), seed=seed))
    assert abs(response.share) < 3.5 * response.share_sigma
    assert abs(response.share) < 0.03
    assert abs(response.delay) < 0.01


@pytest.mark.parametrize("force", [-500.0, 300.0, 800.0])
def test_force_without_pressure(force):
    response = brake_response(*run(brake_force(force=force)))
    usual = np.median(brake_force(force=force)[400:1200])
    assert response.share == pytest.approx(force / usual, abs=3.5 * response.share_sigma)
    assert response.share_sigma * usual < 100.0


@pytest.mark.parametrize("shift", [-0.3, 0.1])
def test_a_clock_that_is_off(shift):
    response = brake_response(*run(brake_force(shift=shift)))
    assert response.delay == pytest.approx(shift, abs=0.01)
    assert abs(response.share) < 0.03


@pytest.mark.parametrize("lag", [0.06, 0.3])
def test_a_hydraulic_lag(lag):
    response = brake_response(*run(brake_force(lag=lag)))
    assert response.delay == pytest.approx(lag, abs=0.005 + 0.05 * lag)  # a slope tells the rest
    assert abs(response.share) < 0.03


def test_fade_and_a_bias_are_not_taken_for_force():
    response = brake_response(*run(brake_force(fade=0.03, resistance=0.03 * WEIGHT)))
    assert abs(response.share) < 0.03


def stopping(force):
    """A run braked to 1 m/s, with a further force [N] that fades from 3 m/s on."""
    speed = np.maximum(22.0 - 4.3 * np.clip(TIME - 1.5, 0.0, None), 0.5)
    fades = force * np.clip(speed - 1.0, 0.0, 2.0) / 2.0 * (pedal(TIME) > 200.0)
    return run(brake_force() + fades, speed=speed)


@pytest.mark.parametrize("force", [0.0, 400.0, 800.0])
def test_a_force_that_fades_as_the_car_gets_slow(force):
    response = brake_response(*stopping(force))
    usual = np.median(brake_force(force=force)[400:1200])
    assert response.fading_sigma < 0.03
    assert response.fading == pytest.approx(force / usual, abs=3.0 * response.fading_sigma)
    assert response.share == pytest.approx(force / usual, abs=3.5 * response.share_sigma)


def test_brakes_that_follow_the_pressure_and_fade_with_the_speed_show_no_force_without_it():
    """A motor in proportion to the pressure: only the end of the stop tells it."""
    s, forces = stopping(0.0)
    speed = s.speed
    share = 0.15 * np.clip(speed - 1.0, 0.0, 2.0) / 2.0
    with_motor = BrakeBalance(
        forces.nominal_f,
        forces.nominal_r,
        made_balance(forces.balance.demanded + share * brake_force()),
        forces.active,
    )
    response = brake_response(s, with_motor)
    assert abs(response.share) < 3.0 * response.share_sigma
    assert response.fading == pytest.approx(0.15 / 1.15, abs=3.0 * response.fading_sigma)
    assert response.fading > 4.0 * response.fading_sigma


def test_a_run_without_braking_has_no_response():
    s, forces = run(brake_force())
    never = np.zeros_like(forces.active)
    silent = BrakeBalance(forces.nominal_f, forces.nominal_r, forces.balance, never)
    assert brake_response(s, silent) is None
