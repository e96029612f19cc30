"""Delays of a pressure that are known, on runs that are made and on runs of cars."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from calib.car.lag import first_order
from calib.logs.read import read_log
from calib.run.run import Run
from tests.support.made_runs import changed, made_run, ramp, stop
from tests.support.refusals import why_not

SAMPLES = Path(__file__).parents[2] / "sample_logs"
RAMPS = (
    "sedan/ramp_wet_asphalt.csv",
    "simulation_study/ramp_noisy.parquet",
    "third_party/cal_ramp.parquet",
)
OMEGAS = tuple(f"omega_{wheel}" for wheel in ("fl", "fr", "rl", "rr"))
BOUND = 0.3  # [s] of `LIMITS.pressure_late`
RUNS = {
    "ramp": made_run(ramp(start=4.0, rate=12.0), duration=10.0, speed=40.0),
    "stop": made_run(stop(start=4.0, end=6.0), duration=10.0, speed=40.0),
}


def late(log, delay):
    """The log with a pressure that was recorded ``delay`` [s] late; its ends are held."""
    then = log.time - delay
    return changed(log, p_mc=np.interp(then, log.time, log["p_mc"]))


def with_wheels(log, rear=lambda p: p, **delays):
    """The log with wheel pressures, those of the ``rear`` by a valve; ``delays`` by channel."""
    p = log["p_mc"]
    wheels = {f"p_{wheel}": rear(p) if wheel[0] == "r" else p for wheel in ("fl", "fr", "rl", "rr")}
    pressures = {"p_mc": p, **wheels}
    for name, p in pressures.items():
        pressures[name] = np.interp(log.time - delays.get(name, 0.0), log.time, p)
    return changed(log, **pressures)


def estimated_delay(log):
    return Run(log).pressures.get("p_mc")


def exceeds_limit(delay):
    return abs(delay.nearest_to_zero) > BOUND


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("delay", [-3.0, -1.5, -1.0, -0.5, 0.0, 0.2, 0.5, 1.0, 1.5, 3.0])
def test_a_delay_is_found_wherever_it_is(name, delay):
    estimate = estimated_delay(late(RUNS[name], delay))
    assert estimate.value == pytest.approx(-delay, abs=0.06)
    assert estimate.low < -delay < estimate.high
    assert estimate.explained > 0.98
    assert exceeds_limit(estimate) == (abs(delay) >= 0.5)


@pytest.mark.parametrize(
    ("name", "delay"), [*product(RAMPS, [0.5, 1.5, 3.0]), *product(RAMPS[:2], [-1.0])]
)
def test_a_late_or_early_pressure_on_the_ramp_of_a_car(name, delay):
    log = late(read_log(SAMPLES / name), delay)
    estimate = estimated_delay(log)
    assert estimate.value == pytest.approx(-delay, abs=0.11)
    assert estimate.low < -delay < estimate.high + 0.01
    assert all(why_not(log, purpose) for purpose in ("fit", "validate"))


@pytest.mark.parametrize("delay", [-0.2, -0.1, 0.1, 0.2])
@pytest.mark.parametrize("name", RAMPS)
def test_brakes_and_filters_may_be_late_by_a_fifth_of_a_second(name, delay):
    log = read_log(SAMPLES / name)
    assert not exceeds_limit(estimated_delay(late(log, delay)))


@pytest.mark.parametrize("lag", [0.1, 0.2])
@pytest.mark.parametrize("name", RUNS)
def test_a_hydraulic_lag_is_a_delay_and_no_mistake(name, lag):
    log = RUNS[name]
    estimate = estimated_delay(changed(log, a_x=first_order(log.time, log["a_x"], lag)))
    assert estimate.value == pytest.approx(lag, abs=0.06)
    assert not exceeds_limit(estimate)


@pytest.mark.parametrize("bar", [1.0, 2.0])
def test_pads_that_bite_late_are_no_late_clock_on_a_slow_ramp(bar):
    """On a straight ramp of 6 bar/s, 2 bar are as good as a third of a second."""
    log = made_run(ramp())
    shifted = changed(log, a_x=made_run(lambda t: np.maximum(ramp()(t) - bar, 0.0))["a_x"])
    assert not exceeds_limit(estimated_delay(shifted))


def test_a_motor_that_is_logged_is_no_late_pressure():
    log = made_run(ramp(start=4.0, rate=12.0), duration=10.0, speed=40.0)
    on = np.clip(log.time - 3.5, 0.0, 1.0)
    motor = changed(log, a_x=log["a_x"] - 1.0 * on, T_drive_f=-500.0 * on)
    assert not exceeds_limit(estimated_delay(motor))
    assert exceeds_limit(estimated_delay(late(motor, 1.0)))


@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("delay", [0.0, 0.5])
def test_a_short_braking_and_a_run_without_noise(noise, delay):
    log = made_run(stop(start=1.0, end=2.1), duration=2.6, noise=noise)
    estimate = estimated_delay(late(log, delay))
    assert estimate.value == pytest.approx(-delay, abs=0.06)
    assert estimate.low < estimate.value < estimate.high


@pytest.mark.parametrize(("end", "duration"), [(4.5, 5.2), (9.0, 6.0)])
@pytest.mark.parametrize("delay", [-2.0, -0.5, 0.4, 0.7])
def test_a_delay_beyond_the_braking_is_not_taken(end, duration, delay):
    """A tap, and a stop that the log ends with: with most of it unknown any delay would do."""
    log = made_run(stop(start=4.0, end=end), duration=duration, speed=40.0)
    assert estimated_delay(late(log, delay)).value == pytest.approx(-delay, abs=0.1)


@pytest.mark.parametrize("delay", [-0.7, 0.0, 0.5, 1.0])
def test_the_delay_is_that_before_a_wheel_locks(delay):
    log = made_run(stop(start=4.0, end=7.0), duration=8.0, speed=40.0)
    omega = np.where(log.time > 5.0, 0.3, 1.0) * log["omega_fl"]
    a_x = np.where(log.time > 5.0, 0.7, 1.0) * log["a_x"]
    estimate = estimated_delay(late(changed(log, omega_fl=omega, a_x=a_x), delay))
    assert estimate.value == pytest.approx(-delay, abs=0.06)
    assert estimate.explained > 0.98


def test_wheel_pressures_that_do_not_follow_the_pedal_are_judged_by_the_deceleration():
    """A motor takes what it can before the brakes do; a car is held while its pedal is free."""
    log = made_run(ramp(start=4.0, rate=12.0), duration=10.0, speed=40.0)
    friction_pressure = np.maximum(log["p_mc"] - 15e5, 0.0)
    torque = -12e3 * 0.3 * (log["p_mc"] - friction_pressure) / 70e5 * 9.81
    blended = changed(
        with_wheels(changed(log, p_mc=friction_pressure)), p_mc=log["p_mc"], T_drive_f=torque
    )
    held_pressure = np.where(log.time > 9.0, 25e5, 0.0)
    still = {x: np.where(log.time > 9.0, 0.0, log[x]) for x in ("v", "p_mc", "a_x", *OMEGAS)}
    parked = changed(with_wheels(log, lambda p: p + held_pressure), **still)
    for honest in (blended, parked):
        assert not any(exceeds_limit(x) for x in Run(honest).pressures.values())
        assert not [x for x in why_not(honest, "validate") if "pressure" in x]
    late_ones = Run(with_wheels(log, **dict.fromkeys(("p_fl", "p_fr", "p_rl", "p_rr"), 1.0)))
    assert list(map(exceeds_limit, late_ones.pressures.values())) == 4 * [True]


def test_an_engine_that_drives_before_the_roll_is_no_delay():
    log = made_run(ramp(start=4.0, rate=12.0), duration=10.0, speed=40.0)
    gears = 1.2 * np.clip(3.2 - log.time, 0.0, 1.0) * (1.0 + np.sin(4.0 * log.time))
    assert not exceeds_limit(estimated_delay(changed(log, a_x=log["a_x"] + gears)))


@pytest.mark.parametrize("early", [0.9, 1.4, 2.5])
def test_a_pressure_that_comes_while_the_car_still_rolls(early):
    log = made_run(stop(start=1.5, end=4.0), duration=6.0, speed=40.0)
    assert any("pressure" in code for code in why_not(late(log, -early), "validate"))


@pytest.mark.parametrize("bar", [0.0, 2.0])
def test_a_wheel_pressure_that_does_not_change_leaves_the_delay_finite(bar):
    hangs = changed(with_wheels(RUNS["ramp"]), p_fl=np.full_like(RUNS["ramp"].time, 1e5 * bar))
    delays = Run(hangs).pressures.values()
    assert delays
    assert np.isfinite([x.value for x in delays]).all()


def test_without_a_braking_or_a_lead_in_there_is_no_delay():
    assert estimated_delay(made_run(lambda t: 0.0 * t)) is None
    log = made_run(stop(start=0.1))
    without_lead_in = replace(log, channels={k: x[100:] for k, x in log.channels.items()})
    assert estimated_delay(without_lead_in) is None
