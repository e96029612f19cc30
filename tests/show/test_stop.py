from dataclasses import replace

import numpy as np
import pytest

from calib.show import stop
from calib.show.style import FRONT, REAR
from tests.support.plot_lines import axes, line


def test_panels_in_the_order_of_the_paper(trace):
    assert stop.sheet(trace).names == (
        "wheel-speeds",
        "deceleration",
        "normalised-forces",
        "slip",
        "pad-front",
        "pad-rear",
        "axle-torques",
        "validity",
    )


def test_pad_friction_with_interval_nominal_and_rivals(trace):
    ax = axes()
    stop.pad(ax, trace, trace.front, FRONT)
    estimate = line(ax, r"estimate $\mu_{p,c}$, 95 %")[1]
    assert np.array_equal(estimate[trace.valid], trace.front.pad[trace.valid])
    assert np.isnan(estimate[~trace.valid]).all()
    assert line(ax, r"$\mu_{p,n}$ of the table")[1] == [trace.front.nominal] * 2
    for name, (label, _) in stop.BASELINES.items():
        rival = line(ax, label)[1]
        assert np.array_equal(rival[trace.valid], trace.front.baselines[name][trace.valid])
        assert np.isnan(rival[~trace.valid]).all()
    low, high = ax.get_ylim()
    held = trace.valid
    assert low < trace.front.lower[held].min()
    assert high > trace.front.upper[held].max()


def test_every_panel_marks_the_change_of_surface(trace):
    (time,) = trace.changes
    assert 8.5 < time < 9.5  # the paper's Fig. 14: at 9 s
    *over_time, why = stop.sheet(trace).overview().axes
    assert why.get_title(loc="left").endswith(stop.WHY)
    for ax in over_time:
        uprights = [one for one in ax.get_lines() if list(one.get_xdata()) == [time, time]]
        assert len(uprights) == 1
    assert stop.CHANGED in stop.sheet(trace).note
    assert stop.CHANGED not in stop.sheet(replace(trace, changes=())).note


def test_a_stop_of_which_nothing_is_valid_is_drawn_all_the_same(trace):
    nowhere = replace(trace, valid=np.zeros(trace.time.size, bool))
    assert len(stop.sheet(nowhere).overview().axes) == 8


def test_what_is_before_the_bite_does_not_set_the_axis(trace):
    """The interval before the bite is that of the prior: some tenths; in the stop a twentieth."""
    ax = axes()
    stop.pad(ax, replace(trace, front=replace(trace.front, nominal=None, baselines={})),
             replace(trace.front, nominal=None, baselines={}), FRONT)  # fmt: skip
    held = trace.valid
    span = trace.front.upper[held].max() - trace.front.lower[held].min()
    before = trace.front.upper[~held].max() - trace.front.lower[~held].min()
    low, high = ax.get_ylim()
    assert span < high - low < 1.3 * span
    assert before > 1.5 * span


def test_a_simulation_shows_its_truth_and_the_error(simulated):
    sheet = stop.sheet(simulated)
    assert (sheet.kind, sheet.names[-2]) == ("simulation", "error")
    ax = axes()
    stop.pad(ax, simulated, simulated.rear, REAR)
    truth = line(ax, "truth")[1][simulated.valid]
    assert truth == pytest.approx(np.full(truth.size, 0.4), rel=0.02)
    ax = axes()
    stop.error(ax, simulated)
    nominal = line(ax, "front nominal")[1]
    # 0.5 where 0.4 is true
    assert nominal[simulated.valid] == pytest.approx(np.full(simulated.valid.sum(), 25.0), abs=1.0)
    assert np.isnan(nominal[~simulated.valid]).all()


def test_no_error_where_nothing_brakes():
    true, valid = np.array([1.0, 0.0, 1.0]), np.array([True, True, False])
    found = stop.relative(np.full(3, 1.05), true, valid)
    assert found[0] == pytest.approx(5.0)
    assert np.isnan(found[1:]).all()
