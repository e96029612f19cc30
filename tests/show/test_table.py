"""The bars are the parts of the budgets, largest first, and all of them on top."""

from dataclasses import replace

import numpy as np
import pytest

from calib.show import table as figures
from calib.show.ramp import measure
from calib.show.table import bars, sheet
from calib.store.answer import answer
from calib.table.budget import AxleBudget
from calib.table.table import EXTRAPOLATED, INTERPOLATED, MEASURED
from tests.support.one_axle import one_axle
from tests.support.plot_lines import axes, drawn, labels, line
from tests.support.reference_car import IDEAL
from tests.support.tables import C, made_table, stored_as

TABLE = made_table()
PERCENT = 100.0 * (TABLE.paper.eta - 1.0)


def pieces(ax, symbol):
    """y of all pieces of a curve put together, by what the flags say."""
    found = [line(ax, f"{symbol} {w}")[1] for w in ("in the table", "interpolated", "extrapolated")]
    return np.nanmax(np.where(np.isnan(found), -np.inf, found), axis=0)


def test_f1_and_f2_are_those_of_the_table():
    ax = axes()
    figures.f1_f2(ax, TABLE)
    assert np.array_equal(pieces(ax, "$f_1$"), TABLE.paper.f1)
    assert np.array_equal(pieces(ax, "$f_2$"), TABLE.paper.f2)
    assert np.array_equal(line(ax, "$f_1$ in the table")[0], PERCENT)


def test_bands_are_those_of_the_table():
    ax = axes()
    figures.difference(ax, TABLE)
    (band,) = ax.collections
    corners = {tuple(v) for v in band.get_paths()[0].vertices}
    assert set(zip(PERCENT, TABLE.difference.lower, strict=True)) <= corners
    assert set(zip(PERCENT, TABLE.difference.upper, strict=True)) <= corners


def test_d_is_the_straight_line_it_was_made_as():
    ax = axes()
    figures.difference(ax, TABLE)
    assert pieces(ax, "$D$") == pytest.approx(C * PERCENT / 100.0)


def test_a_piece_is_as_bad_as_the_worse_of_its_ends():
    flag = np.array([INTERPOLATED, MEASURED, MEASURED, INTERPOLATED, MEASURED, EXTRAPOLATED])
    x = np.arange(6.0)
    ax = axes()
    figures.by_flag(ax, x, x, flag, {"color": "black"}, "c")
    assert list(np.isnan(line(ax, "c in the table")[1])) == [True, False, False, True, True, True]
    assert list(np.isnan(line(ax, "c extrapolated")[1])) == [True] * 4 + [False] * 2


def test_a_table_that_is_measured_throughout_names_nothing_else():
    flag = np.full(21, MEASURED)
    ax = axes()
    figures.f1_f2(ax, replace(TABLE, paper=replace(TABLE.paper, flag=flag)))
    curves = [label for label in labels(ax) if label.startswith("$f")]
    assert curves == ["$f_1$ in the table", "$f_2$ in the table"]


def test_coverage_is_the_count():
    ax = axes()
    figures.coverage(ax, TABLE)
    x, y = line(ax, "blocks in the cell")
    assert np.array_equal(x, PERCENT)
    assert np.array_equal(y, TABLE.difference.count)
    assert all(tick == round(tick) for tick in ax.get_yticks())


def test_the_axles_at_p_lie_on_the_tyre_curve_on_both_sides_of_it():
    ax = axes()
    figures.tyre(ax, TABLE)
    marks = [one.get_xydata()[0] for one in ax.get_lines() if one.get_marker() == "s"]
    assert [text.get_text() for text in ax.texts] == ["front at 0.3 g", "rear at 0.3 g"]
    (front, rear) = marks
    assert front[1] > 0.3 > rear[1]
    # z = K (eta - 1) = 0.3 at eta - 1 = 0.005: D = 27 * 0.005, and g = C slip is linear
    assert front[1] - rear[1] == pytest.approx(0.135)
    for slip, force in marks[1:]:
        assert force == pytest.approx(C * slip / 100.0)


def test_a_table_that_ends_before_p_does_not_mark_it():
    ax = axes()
    figures.tyre(ax, replace(TABLE, paper=replace(TABLE.paper, z=0.5 * TABLE.paper.z)))
    assert len(ax.texts) == 0


def test_what_a_ramp_measured_stands_beside_the_curves(sedan, ramp):
    run = measure(sedan, ramp)
    percent = 100.0 * (run.eta - 1.0)
    beyond = run.z_free > sedan.paper.z[-1]
    ax = axes()
    figures.f1_f2(ax, sedan, (run,))
    for part in (run.braked & beyond, run.braked & ~beyond):
        assert part.any()
        assert drawn(ax, percent[part], run.f1[part])
        assert drawn(ax, percent[part], run.f2[part])
    ax = axes()
    figures.tyre(ax, sedan, (run,))
    assert {"front axle, ramps", "rear axle, ramps"} <= {*labels(ax)}
    assert drawn(ax, 100.0 * run.slip_r[run.braked], run.F_r[run.braked])


def test_a_ramp_with_one_axle_is_not_drawn_over_the_curves_of_both(sedan, ramp):
    alone = measure(sedan, one_axle(IDEAL, "r"))
    for draw in (figures.f1_f2, figures.difference):
        bare, with_it, normal = axes(), axes(), axes()
        draw(bare, sedan)
        draw(with_it, sedan, (alone,))
        draw(normal, sedan, (measure(sedan, ramp),))
        assert len(with_it.lines) == len(bare.lines) < len(normal.lines)


def test_a_ramp_without_v_leaves_the_tyre_curve_alone(sedan, ramp):
    run = replace(measure(sedan, ramp), slip_f=None, slip_r=None)
    ax = axes()
    figures.tyre(ax, sedan, (run,))
    assert "front axle, ramps" not in labels(ax)


def test_the_sheet_names_digest_and_parents():
    sheet = figures.sheet(TABLE, "sedan@3")
    assert "sedan@3" in sheet.title
    assert TABLE.digest[:16] in sheet.note
    assert "ramp.csv, coast.csv" in sheet.note


def test_each_ramp_has_a_row(sedan, ramp):
    run = measure(sedan, ramp)
    assert figures.sheet(sedan, "s", (run,)).rows[4:] == (("pressure", "forces"),)
    both = figures.sheet(sedan, "s", (run, run))
    assert both.rows[4:] == (("pressure-1", "forces-1"), ("pressure-2", "forces-2"))


def test_the_usable_range_is_marked_in_eta_and_deceleration():
    # z = 60 (eta - 1), known up to 0.475 % and 0.285 g; 0.1 g is at 1/600 and 0.2 g at 1/300
    percent, end = 100.0 * (TABLE.paper.eta[-2] - 1.0), TABLE.paper.z[-2]
    assert (percent, end) == pytest.approx((0.475, 0.285))
    for draw in (figures.f1_f2, figures.difference):
        ax = axes()
        draw(ax, TABLE)
        assert list(line(ax, f"usable to {percent:.2f} %, {end:.2f} g")[0]) == pytest.approx(
            [0.475, 0.475]
        )
        marks = {text.get_text(): text.xy[0] for text in ax.texts}
        assert marks["0.1 g"] == pytest.approx(1.0 / 6.0)
        assert marks["0.2 g"] == pytest.approx(1.0 / 3.0)
        shaded = [patch.get_extents().transformed(ax.transData.inverted()) for patch in ax.patches]
        assert shaded[0].x0 == pytest.approx(0.475)
        assert shaded[0].x1 == pytest.approx(ax.get_xlim()[1])


def test_grey_points_are_explained_in_the_panel(sedan, ramp):
    ax = axes()
    figures.difference(ax, sedan, (measure(sedan, ramp),) * 2)
    told = [label for label in labels(ax) if "not usable" in label]
    assert told == [f"above {sedan.paper.z[-1]:.2f} g: not usable"]
    assert labels(ax).count(f"ramps, {figures.FREED}") == 1


def test_the_page_begins_with_pads_and_range():
    # made_table: 0.4 with a sigma of 0.01, 0.39 with 0.02; usable up to 0.285 g
    result = figures.sheet(TABLE, "sedan@1").result
    assert "front 0.400\u00a0\u00b1\u00a00.020, rear 0.390\u00a0\u00b1\u00a00.039" in result
    assert result.endswith(f"usable up to {TABLE.paper.z[-2]:.2f}\u00a0g")


def test_the_usable_range_is_the_same_in_the_answer_and_in_the_picture():
    stored = stored_as("sedan@1")
    last = answer(stored).decelerations[1]
    assert last == pytest.approx(0.285)
    assert f"usable up to {last:.2f}" in figures.sheet(stored.table, "sedan@1").result


FRONT = AxleBudget(0.40, {"zeros": 1e-6, "mass": 9e-4})
REAR = AxleBudget(0.38, {"unlike_pads": 16e-4, "mass": 9e-4})


def drawn_bars():
    ax = axes()
    bars(ax, (FRONT, REAR))
    return ax, {c.get_label(): [bar.get_width() for bar in c] for c in ax.containers}


def test_a_bar_is_as_long_as_its_part():
    ax, widths = drawn_bars()
    assert [label.get_text() for label in ax.get_yticklabels()] == [
        *("all", "unlike pads", "mass", "zeros"),
    ]
    assert widths["front"] == pytest.approx([100.0 * np.sqrt(9.01e-4), 0.0, 3.0, 0.1])
    assert widths["rear"] == pytest.approx([5.0, 4.0, 3.0, 0.0])


def test_the_numbers_stand_beside_the_longer_bar_and_inside_the_axes():
    ax, widths = drawn_bars()
    assert [text.get_text() for text in ax.texts] == [
        *(" 3.0 / 5.0", " 0.0 / 4.0", " 3.0 / 3.0", " 0.1 / 0.0"),
    ]
    assert [text.get_position()[0] for text in ax.texts] == pytest.approx([5.0, 4.0, 3.0, 0.1])
    assert ax.get_xlim()[1] > max(max(x) for x in widths.values())


def test_a_table_of_before_draws_what_it_knows():
    figure = sheet(made_table(), "sedan@1").figure("budget")
    names = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert names == ["all", "ramp"]
