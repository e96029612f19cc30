"""The pressure of a run goes with its deceleration, that of another run does not."""

import numpy as np
import pytest

from calib.run.check import check, problems_for
from calib.run.observation import observe
from tests.support.made_runs import changed, made_run, ramp, stop

RUN = made_run(stop())


def share(log):
    return observe(log, noise=False).explained


@pytest.mark.parametrize("pressure", [ramp(), stop(), stop(level=8.0), stop(end=4.0)])
def test_the_pressure_of_the_run_explains_it(pressure):
    assert share(made_run(pressure)) > 0.98


def test_pads_that_lose_a_third_and_lines_that_lag_are_no_mistake():
    t, p = RUN.time, RUN["p_mc"]
    faded = RUN["a_x"] * (1.0 - 0.33 * t / t[-1])
    late = np.interp(t - 0.25, t, faded)
    assert share(changed(RUN, a_x=late)) > 0.95
    assert share(changed(RUN, p_mc=np.maximum(p - 2e5, 0.0))) > 0.95


@pytest.mark.parametrize(
    "pressure",
    [lambda t: 0.0 * t, stop(start=4.0), lambda t: 25.0 * ((t > 1.5) & (np.sin(3.0 * t) > 0.0))],
    ids=["none", "later", "on and off"],
)
def test_a_pressure_of_another_run_does_not(pressure):
    wrong = changed(RUN, p_mc=made_run(pressure)["p_mc"])
    assert share(wrong) < 0.85
    for purpose in ("fit", "validate", "diagnose"):
        assert any("another run" in text for text in problems_for(wrong, purpose))


def test_a_motor_whose_torque_is_logged_brakes_without_pressure():
    motor = changed(RUN, p_mc=0.0 * RUN["p_mc"], T_drive_f=0.0 * RUN["p_mc"] - 300.0)
    assert share(motor) is None


def test_a_glitch_of_a_x_does_not_count():
    a_x = RUN["a_x"].copy()
    a_x[700:703] = -80.0
    assert share(changed(RUN, a_x=a_x)) > 0.98


def test_a_speed_made_of_wheels_is_none_for_a_diagnosis():
    wheels = [RUN[f"omega_{w}"] for w in ("fl", "fr", "rl", "rr")]
    for made in (0.32 * wheels[2], 0.08 * sum(wheels)):
        run = changed(RUN, v=made)
        assert any("made of the wheel speeds" in text for text in problems_for(run, "diagnose"))
    assert problems_for(RUN, "diagnose") == []
    assert check(RUN).seen.v_of_wheels is False
