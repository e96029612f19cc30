"""What a log is good for although it lacks something."""

import numpy as np

from calib.run.observation import observe
from calib.run.rules import uses
from tests.support.made_runs import changed, made_run, stop


def said(log):
    return " ".join(uses(observe(log)))


def test_without_pressure_the_rest_still_counts():
    text = said(changed(made_run(stop()), p_mc=None))
    assert "zero of eta" in text
    assert "fine for a table" in text
    assert "makes a radius of 0.3" in text
    assert "of 1 braking(s); without pressure no torque" in text


def test_coarse_wheels_are_called_so():
    assert "too coarse for a table" in said(made_run(stop(), noise=40.0))


def test_without_wheels_there_is_nothing_to_say():
    assert said(changed(made_run(), omega_fl=None)) == ""


def test_a_logged_drive_is_said_to_be_taken_out():
    run = made_run(stop())
    assert "motor" not in said(run)
    assert "less the torque of engine or motor: T_drive_f" in said(
        changed(run, T_drive_f=np.zeros(run.time.size))
    )
