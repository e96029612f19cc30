"""The temperature model: the exponential, the heat of a stop, the first value, what is known."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.disc_temperature import DISCS, START
from calib.car.effects.effects import Effects
from calib.estimation.temperature import temperature, temperatures
from calib.run.axle_signals import signals
from tests.support.reference_car import CAR, IDEAL, noisy, stop


@pytest.fixture(scope="module")
def log():
    return stop(IDEAL, 40e5)


def rolling(log, pressure, omega):
    """The log at a constant pressure [Pa] and wheel speed [rad/s]: a descent."""
    held = {"p_mc": pressure, **{f"omega_{w}": omega for w in ("fl", "fr", "rl", "rr")}}
    channels = {name: np.full_like(log.time, x) for name, x in held.items()}
    return replace(log, channels={**log.channels, **channels})


def test_constant_braking_gives_the_exponential(log):
    """mu = mu_n (1 - 0.001 (T - 150)) above 150 degC; T by the closed form of the disc."""
    descent = rolling(log, 30e5, 60.0)
    front, rear = temperature(CAR, descent, signals(descent, CAR), Effects())
    t = log.time - log.time[0]
    for pads, gain, capacity in (
        (front, 2.0 * 28.84e-4 * 0.1309, 3700.0),
        (rear, 2.0 * 11.34e-4 * 0.1240, 2300.0),
    ):
        end = 20.0 + 0.38 * gain * 30e5 * 60.0 * 300.0 / capacity
        T = end + (100.0 - end) * np.exp(-t / 300.0)
        assert T[-1] > 150.0
        assert pads == pytest.approx(0.38 * (1.0 - 0.001 * np.maximum(T - 150.0, 0.0)), rel=1e-9)


def test_heat_is_that_of_the_brakes(log):
    """Heat kept and heat given to the air are what the plant's brakes, of nominal pads, make."""
    found = temperatures(CAR, log, signals(log, CAR))
    for side, disc in DISCS.items():
        T = found[side]
        power = log.truth[f"true_Tb_{side}l"] * log[f"omega_{side}l"]
        cooled = np.trapezoid(T - 20.0, log.time) / disc.cooling_time
        made = np.trapezoid(power, log.time) / disc.heat_capacity
        assert T[0] == START
        assert T[-1] - START + cooled == pytest.approx(made, rel=0.005)


def test_a_logged_temperature_gives_the_start(log):
    warm = {"T_disc_f": np.linspace(400.0, 900.0, log.time.size)}
    hot = replace(log, channels={**log.channels, **warm})
    front, rear = temperature(CAR, hot, signals(hot, CAR), Effects())
    assert front[0] == pytest.approx(0.38 * 0.75)
    assert front[-1] > 0.38 * 0.6
    assert rear[0] == 0.38


def test_it_is_causal(log):
    log = noisy(log, 1)
    later = rolling(log, 90e5, 90.0)
    half = log.time.size // 2
    mixed = {name: np.where(np.arange(log.time.size) < half, x, later[name])
             for name, x in log.channels.items()}  # fmt: skip
    mixed = replace(log, channels=mixed)
    one, other = (temperatures(CAR, x, signals(x, CAR)) for x in (log, mixed))
    for side in "fr":
        assert one[side][:half] == pytest.approx(other[side][:half], abs=1e-9)
        assert other[side][-1] > one[side][-1] + 10.0


def test_it_knows_nothing_of_wet_pads(log):
    """The same pressure and speed give the same pads, whatever the car decelerates."""
    wet = replace(log, channels={**log.channels, "a_x": 0.5 * log["a_x"]})
    one, other = (temperature(CAR, x, signals(x, CAR), Effects()) for x in (log, wet))
    assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))
