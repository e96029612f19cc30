from dataclasses import replace

import numpy as np
import pytest

from calib.plots import log as figures
from tests.support.plot_lines import axes, drawn, labels, line


def without(log, *names):
    return replace(log, channels={k: v for k, v in log.channels.items() if k not in names})


def test_what_is_logged_is_drawn(transition):
    ax = axes()
    figures.speeds(ax, transition)
    assert np.array_equal(line(ax, "rl")[1], transition["omega_rl"])
    ax = axes()
    figures.pressure(ax, transition)
    assert drawn(ax, transition.time, transition["p_mc"] / 1e5)
    ax = axes()
    figures.deceleration(ax, transition)
    assert drawn(ax, transition.time, -transition["a_x"] / 9.80665)


def test_the_right_hand_axis_is_the_speed_in_kmh(transition):
    ax = axes()
    figures.speeds(ax, transition)
    (right,) = ax.child_axes
    assert right.get_ylabel() == "$V$ [km/h]"
    ax.set_ylim(0.0, 100.0)
    ax.figure.draw_without_rendering()
    # 100 rad/s at the 0.32 m that the legend names
    assert right.get_ylim() == pytest.approx((0.0, 100.0 * 0.32 * 3.6))
    assert "$V$ / 0.32 m" in labels(ax)


def test_eta_is_raw_and_ends_where_the_car_stands(transition):
    found = figures.raw_eta(transition)
    rear = transition["omega_rl"] + transition["omega_rr"]
    front = transition["omega_fl"] + transition["omega_fr"]
    assert found[0] == pytest.approx(100.0 * (rear / front - 1.0)[0])
    standing = without(transition, "v")
    slow = {f"omega_{w}": np.zeros(transition.time.size) for w in ("fl", "fr", "rl", "rr")}
    standing = replace(standing, channels=standing.channels | slow)
    assert np.isnan(figures.raw_eta(standing)).all()
    assert len(figures.sheet(standing).overview().axes) == 4


@pytest.mark.parametrize(
    ("missing", "panels"),
    [
        (("v",), ("speeds", "pressure", "deceleration", "eta")),
        (("p_mc",), ("speeds", "deceleration", "eta")),
        (("a_x",), ("speeds", "pressure", "eta")),
        (("omega_rl",), ("speeds", "pressure", "deceleration")),
    ],
)
def test_what_is_not_logged_has_no_panel_and_is_named(transition, missing, panels):
    sheet = figures.sheet(without(transition, *missing))
    assert sheet.names == panels
    assert f"Not in this log: {', '.join(missing)}." in sheet.note
    assert len(sheet.overview().axes) == len(panels)


def test_wheel_pressures_are_drawn_where_logged(transition):
    more = {"p_fl": 0.9 * transition["p_mc"]}
    ax = axes()
    figures.pressure(ax, replace(transition, channels=transition.channels | more))
    assert labels(ax) == ["master cylinder", "fl"]
    assert drawn(ax, transition.time, more["p_fl"] / 1e5)
