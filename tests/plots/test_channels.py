"""All columns of a log in one picture."""

import numpy as np
import pytest

from calib.checks.events import BITE, BRAKING, RunEvent
from calib.logs.whole import WholeColumn, WholeLog
from calib.plots.channels import BINS, MOST, envelope, figure, panels_of

TIME = np.arange(200) / 100.0
COLUMNS = (
    WholeColumn("time", "s", TIME),
    *(WholeColumn(f"omega_f{side}", "rad/s", 50.0 - TIME) for side in "lr"),
    WholeColumn("omega_rl", "rpm", 500.0 - TIME),
    WholeColumn("Gang", None, np.full(200, np.nan)),
)
LOG = WholeLog("run", "here", "", COLUMNS)


def test_columns_of_one_kind_and_unit_share_a_panel():
    assert {title: len(found) for title, found in panels_of(LOG).items()} == {
        "omega [rad/s]": 2, "omega [rpm]": 1, "Gang [?]": 1,
    }  # fmt: skip


def test_events_are_marked_in_every_panel():
    drawn = figure(LOG, (RunEvent(BITE, 0.5, 0.5), RunEvent(BRAKING, 0.5, 1.5)))
    assert len(drawn.axes) == 3
    for ax in drawn.axes:
        assert any(np.allclose(line.get_xdata(), 0.5) for line in ax.lines)
        assert ax.patches[0].get_x() == pytest.approx(0.5)
        assert ax.get_xlim() == (TIME[0], TIME[-1])
    assert [text.get_text() for text in drawn.legends[0].get_texts()] == [BITE, BRAKING]


def test_no_peak_of_a_long_log_is_lost():
    values = np.zeros(100_000)
    values[43_210], values[70_000:80_000] = 7.0, np.nan
    at, drawn = envelope(np.arange(100_000.0), values)
    assert at.size == drawn.size == 2 * BINS
    assert np.nanmax(drawn) == 7.0
    assert abs(at[np.nanargmax(drawn)] - 43_210) <= 50
    assert np.isnan(drawn).sum() == 2 * BINS // 10


def test_too_many_columns_are_refused():
    many = tuple(WholeColumn(f"x{i}", "bar", TIME) for i in range(MOST + 1))
    with pytest.raises(ValueError, match=f"at most {MOST}"):
        figure(WholeLog("run", "here", "", (COLUMNS[0], *many)))
