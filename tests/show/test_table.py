import numpy as np
import pytest

from calib.show import table as figures
from calib.show.ramp import measure
from calib.table.table import EXTRAPOLATED, INTERPOLATED, MEASURED
from tests.support.plot_lines import axes, drawn, labels, line
from tests.support.reference_car import IDEAL, one_axle
from tests.support.tables import C, made_table

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


def test_a_piece_is_as_bad_as_the_worse_of_its_ends():
    flag = np.array([INTERPOLATED, MEASURED, MEASURED, INTERPOLATED, MEASURED, EXTRAPOLATED])
    x = np.arange(6.0)
    ax = axes()
    figures.by_flag(ax, x, x, flag, {"color": "black"}, "c")
    assert list(np.isnan(line(ax, "c in the table")[1])) == [True, False, False, True, True, True]
    assert list(np.isnan(line(ax, "c extrapolated")[1])) == [True] * 4 + [False] * 2


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
