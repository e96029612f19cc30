"""Left against right, on runs whose slips are a closed form."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.line.station.metrics import side_difference
from calib.run.run import Run
from tests.support.made_runs import changed, made_run, ramp
from tests.support.tables import made_table

TABLE = made_table()


def with_imbalance(log, share, axle="f"):
    """The run with (1 + share/2) times the slip on the left, (1 - share/2) on the right."""
    v, channels = log["v"], {}
    for side, sign in (("l", 1.0), ("r", -1.0)):
        slip = 1.0 - log[f"omega_{axle}{side}"] * 0.32 / np.maximum(v, 1.0)
        scaled = slip * (1.0 + sign * share / 2.0)
        channels[f"omega_{axle}{side}"] = v / 0.32 * (1.0 - scaled)
    return changed(log, **channels)


@pytest.mark.parametrize(("share", "axle"), [(-0.3, "f"), (0.2, "r")])
def test_the_imbalance_is_found_on_a_straight_tyre(share, axle):
    log = with_imbalance(made_run(noise=0.0), share, axle)
    omega = log[f"omega_{axle}l"]
    log = changed(log, **{f"omega_{axle}l": omega * 1.003})  # a radius is no imbalance
    difference = side_difference(TABLE, Run(log), axle)
    of_other_axle = side_difference(TABLE, Run(log), "r" if axle == "f" else "f")
    assert difference == pytest.approx(share, abs=0.01)
    assert of_other_axle == pytest.approx(0.0, abs=0.01)


def test_a_difference_of_the_pressures_is_not_one_of_the_pads():
    log = with_imbalance(made_run(noise=0.0), 0.2)
    p = log["p_mc"]
    log = changed(log, p_fl=1.1 * p, p_fr=0.9 * p)
    assert side_difference(TABLE, Run(log), "f") == pytest.approx(0.0, abs=0.01)


def test_not_known_without_speed_without_braking_or_in_noise():
    log = made_run()
    assert side_difference(TABLE, Run(changed(log, v=None)), "f") is None
    assert side_difference(TABLE, Run(made_run(lambda t: 0.0 * t)), "f") is None
    assert side_difference(TABLE, Run(made_run(noise=30.0)), "f") is None


C, B = 27.0, 20.0


def with_nonlinear_tyre(end):
    """The table with the tyre F = C s (1 - B s) up to the slip ``end``; its top is at 0.025."""
    slip = np.linspace(0.0, end, 401)
    return replace(TABLE, tyre=replace(TABLE.tyre, slip=slip, force=C * slip * (1.0 - B * slip)))


def slip_at(force):
    return (1.0 - np.sqrt(1.0 - 4.0 * B * force / C)) / (2.0 * B)


def with_forces(log, share):
    """The front wheels carry (1 + share/2) and (1 - share/2) of 0.4 times the deceleration."""
    z, v = -log["a_x"] / G, log["v"]
    return changed(
        log,
        **{
            f"omega_f{side}": v / 0.322 * (1.0 - slip_at(0.4 * (1.0 + sign * share / 2.0) * z))
            for side, sign in (("l", 1.0), ("r", -1.0))
        },
    )


@pytest.mark.parametrize("share", [-1.2, 0.2])
def test_on_a_nonlinear_tyre_it_is_the_force_that_differs(share):
    log = with_forces(made_run(ramp(top=30.0), noise=0.0), share)
    assert side_difference(with_nonlinear_tyre(0.024), Run(log), "f") == pytest.approx(
        share, abs=0.01
    )
