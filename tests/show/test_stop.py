from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.show import stop
from calib.show.stop import validity
from calib.show.style import FRONT
from calib.show.trace import from_validation
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


def test_wheel_speeds_and_the_reference_speed(trace, transition):
    ax = axes()
    stop.wheel_speeds(ax, trace)
    for wheel in ("fl", "fr", "rl", "rr"):
        assert np.array_equal(line(ax, wheel)[1], transition[f"omega_{wheel}"])
    assert line(ax, "$V/R$")[1] == pytest.approx(transition["v"] / 0.322)


def test_deceleration_and_forces_are_the_records(trace):
    ax = axes()
    stop.deceleration(ax, trace)
    assert drawn(ax, trace.time, trace.z)
    ax = axes()
    stop.normalised_forces(ax, trace)
    assert drawn(ax, trace.time, trace.front.force)
    assert drawn(ax, trace.time, trace.rear.force)


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


def test_axle_torques_nominal_and_compensated(trace):
    ax = axes()
    stop.axle_torques(ax, trace)
    assert drawn(ax, trace.time, trace.front.torque / 1e3)
    assert drawn(ax, trace.time, trace.rear.nominal_torque / 1e3)


def test_the_sum_of_forces_says_that_it_proves_nothing(trace):
    ax = axes()
    stop.force_sum(ax, trace)
    assert [text.get_text() for text in ax.texts] == ["true for any table: no validation"]
    assert drawn(ax, trace.time, trace.force_sum / 1e3)
    assert drawn(ax, trace.time, trace.inertia / 1e3)


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


def test_a_trace_without_speeds_and_sum_has_no_such_panels(trace):
    bare = replace(trace, wheels={}, force_sum=None, budget=None, refused={})
    sheet = stop.sheet(bare)
    assert sheet.names[0] == "deceleration"
    assert "force-sum" not in sheet.names
    assert len(sheet.overview().axes) == 6
    odd = stop.sheet(replace(trace, wheels={}, budget=None))
    assert odd.rows[-2:] == (("force-sum", "force-sum"), ("validity", "validity"))


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


def test_other_methods_are_drawn_only_where_they_are_asked_for(sedan, transition, trace):
    result = validate_one(sedan, transition, None, DEFAULTS, baselines=False)
    alone = from_validation(sedan, "sedan@1", transition, result)
    ax = axes()
    stop.pad(ax, alone, alone.front, FRONT)
    assert labels(ax) == [r"estimate $\mu_{p,c}$, 95 %", r"$\mu_{p,n}$ of the table"]
    assert np.array_equal(alone.front.pad, trace.front.pad, equal_nan=True)


def test_the_title_has_verdict_and_pads(trace):
    front, rear = trace.pads
    mean = float(np.mean(trace.front.pad[trace.valid]))
    assert float(front.partition("\u00a0")[0]) == pytest.approx(mean, abs=0.002)
    assert stop.sheet(trace).result == (
        f"{trace.verdict.capitalize()}; pad friction front {front}, rear {rear} (95 %)"
    )
    unknown = stop.sheet(replace(trace, pads=(None, None), verdict=""))
    assert unknown.result == "Pad friction front none, rear none (95 %)"


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
