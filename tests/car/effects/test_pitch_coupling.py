"""Pitch: a mode with the frequency, damping and gradient that it was given; the plant's mode."""

import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from calib.base.names import G
from calib.car.effects.pitch_coupling import EFFECT, pitch_deficit
from tests.support.effect_runs import SEDAN, apart, driven, made_history, on_the_plant

PITCH = {
    "elastic_share": 1.0,
    "natural_frequency": 2.0 * np.pi * 1.5,
    "damping": 0.25,
    "pitch_gradient": 0.03,
}


def by_continuous_time(z, time, frequency, damping):
    """h/L (z - the mode's answer), simulated in continuous time, in balance at first."""
    mode = ([frequency**2], [1.0, 2.0 * damping * frequency, frequency**2])
    moved = z[0] + scipy.signal.lsim(mode, z - z[0], time)[1]
    return (z - moved) * SEDAN.cg_height / SEDAN.wheelbase


@pytest.mark.parametrize("damping", [0.1, 0.3, 0.7])
@pytest.mark.parametrize("frequency", [6.0, 10.0])
def test_deficit_is_that_of_the_continuous_mode(frequency, damping):
    """At every rate: z runs straight between the samples of both."""
    for rate in (40.0, 200.0):
        time = np.arange(round(5.0 * rate)) / rate
        z = 0.02 + 0.3 * np.clip((time - 1.0) / 0.25, 0.0, 1.0)
        expected = by_continuous_time(z, time, frequency, damping)
        late = pitch_deficit(SEDAN, time, z, frequency, damping)
        assert np.max(np.abs(late - expected)) < 1e-9
        assert np.max(np.abs(expected)) > 0.01


@given(z=st.floats(-0.5, 1.0), rate=st.sampled_from([40.0, 200.0, 1000.0]))
def test_deficit_of_a_constant_deceleration_is_zero(z, rate):
    late = pitch_deficit(SEDAN, np.arange(300) / rate, np.full(300, z), 8.0, 0.3)
    assert np.max(np.abs(late)) < 1e-9


def test_deficit_does_not_depend_on_the_future():
    time, z = np.arange(400) * 0.005, np.random.default_rng(1).normal(size=400)
    other = np.concatenate([z[:200], np.zeros(200)])
    both = [pitch_deficit(SEDAN, time, x, 8.0, 0.3)[:200] for x in (z, other)]
    assert np.array_equal(*both)


def test_the_effect_is_its_share_of_the_deficit():
    rng = np.random.default_rng(4)
    trace = made_history(500, z=rng.normal(size=500))
    late = pitch_deficit(SEDAN, trace.time, trace.z, PITCH["natural_frequency"], PITCH["damping"])
    shift = EFFECT.load_shift(SEDAN, {**PITCH, "elastic_share": 0.4}, trace)
    assert shift == pytest.approx(0.4 * late)


def step(t):
    return min(max(t - 1.0, 0.0) * 250e5, 25e5)


def test_a_step_overshoots_as_the_damping_says():
    """Step of z: overshoot exp(-pi D/sqrt(1 - D^2)) after half a damped period."""
    time = np.arange(4000) * 1e-3
    history = made_history(4000, time=time, z=np.where(time >= 0.5, 0.4, 0.0))
    felt = EFFECT.accelerometer(SEDAN, PITCH, history, np.zeros(4000)) / (-G * 0.03 * 0.4)
    root = np.sqrt(1.0 - 0.25**2)
    assert np.max(felt) == pytest.approx(1.0 + np.exp(-np.pi * 0.25 / root), abs=1e-3)
    assert time[np.argmax(felt)] - 0.5 == pytest.approx(0.5 / (1.5 * root), abs=2e-3)


def test_held_it_is_gravity_on_a_pitched_sensor_and_no_load_is_late():
    history = made_history(2000, z=np.full(2000, 0.5))
    a_x = EFFECT.accelerometer(SEDAN, PITCH, history, np.full(2000, -0.5 * G))
    assert a_x == pytest.approx(-0.5 * G * 1.03)  # nose down: reads more deceleration
    assert EFFECT.load_shift(SEDAN, PITCH, history) == pytest.approx(0.0, abs=1e-12)


def test_at_first_the_front_lacks_all_of_the_transfer_that_springs_carry():
    history = made_history(3, time=np.array([0.0, 1e-6, 2e-6]), z=np.array([0.0, 0.4, 0.4]))
    late = EFFECT.load_shift(SEDAN, {**PITCH, "elastic_share": 0.7}, history)
    assert late[1:] == pytest.approx(0.7 * 0.4 * SEDAN.cg_height / SEDAN.wheelbase, rel=1e-6)


def test_follows_the_plant_with_a_pitch_mode():
    log = driven({"pitch_coupling": PITCH}, step)
    run = on_the_plant(step, pitch_frequency=1.5, pitch_damping=0.25)
    assert apart(log, run, "true_Fz_fl") < 10.0
    assert apart(driven({}, step), run, "true_Fz_fl") > 200.0
    biting = run["time"] > 1.15  # d omega/dt is known to half a sample
    eta = run["omega_rl"] / run["omega_fl"]
    off = np.abs(log["omega_rl"] / log["omega_fl"] - eta)[biting]
    assert np.max(off) < 2e-5
    assert apart(log, run, "v") < 5e-3


def test_the_weight_stays():
    log = driven({"pitch_coupling": PITCH}, step)
    total = sum(log.truth[f"true_Fz_{w}"] for w in ("fl", "fr", "rl", "rr"))
    assert total == pytest.approx(SEDAN.weight)
