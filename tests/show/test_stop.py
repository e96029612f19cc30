from dataclasses import replace

import numpy as np
import pytest

from calib.show import stop
from calib.show.stop import validity
from calib.show.style import FRONT
from tests.support.plot_lines import axes, drawn, labels, line


def test_panels_in_the_order_of_the_paper(trace):
    assert stop.sheet(trace).names == (
        "wheel-speeds",
        "deceleration",
        "normalised-forces",
        "slip",
        "pad-front",
        "pad-rear",
        "axle-torques",
        "force-sum",
        "validity",
        "budget",
    )


def test_slip_where_v_is_known_and_eta_always(trace):
    ax = axes()
    stop.slip(ax, trace)
    assert labels(ax) == ["front slip", "rear slip", r"$\eta - 1$, zeroed"]
    assert drawn(ax, trace.time, 100.0 * trace.front.slip)
    ax = axes()
    front, rear = (replace(axle, slip=None) for axle in (trace.front, trace.rear))
    stop.slip(ax, replace(trace, front=front, rear=rear))
    assert labels(ax) == [r"$\eta - 1$, zeroed"]
    assert ax.get_ylabel() == r"$\eta - 1$ [%]"


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
    *over_time, why, made_of = stop.sheet(trace).overview().axes
    assert why.get_title(loc="left").endswith(stop.WHY)
    assert made_of.get_title(loc="left").endswith(stop.BUDGET)
    for ax in over_time:
        uprights = [one for one in ax.get_lines() if list(one.get_xdata()) == [time, time]]
        assert len(uprights) == 1
    assert stop.CHANGED in stop.sheet(trace).note
    assert stop.CHANGED not in stop.sheet(replace(trace, changes=())).note


def test_samples_that_are_not_valid_are_shaded(trace):
    ax = axes()
    stop.deceleration(ax, trace)
    (area,) = ax.collections
    first = trace.time[np.argmax(trace.valid)]
    before = area.get_paths()[0].vertices[:, 0]
    assert before.min() == trace.time[0]
    assert before.max() == pytest.approx(first, abs=0.0051)


def test_a_stop_of_which_nothing_is_valid_is_drawn_all_the_same(trace):
    nowhere = replace(trace, valid=np.zeros(trace.time.size, bool))
    assert len(stop.sheet(nowhere).overview().axes) == 10


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


def test_each_reason_has_its_spans(trace):
    ax = axes()
    time = np.arange(0.0, 10.0, 0.01)
    late, slow = time > 8.0, time > 9.0
    validity(ax, replace(trace, time=time, valid=~late, refused={"a": late, "slow": slow}))
    assert [text.get_text() for text in ax.texts] == [" valid: 8.0 s", " a: 2.0 s", " slow: 1.0 s"]
    ends = [
        (bar.get_paths()[0].vertices[:, 0].min(), bar.get_paths()[0].vertices[:, 0].max())
        for bar in ax.collections
    ]
    assert np.allclose(ends, [(0.0, 8.0), (8.0, 10.0), (9.0, 10.0)], atol=0.011)
