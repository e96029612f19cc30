"""All columns of a log in one picture."""

from dataclasses import replace

import numpy as np
import pytest

from calib.logs.whole import WholeColumn, WholeLog
from calib.run.driving_record import BITES, BRAKING, RunEvent
from calib.show import log as figures
from calib.show.log import BINS, MOST, envelope, figure
from tests.support.plot_lines import drawn, labels


def without(log, *names):
    return replace(log, channels={k: v for k, v in log.channels.items() if k not in names})


def test_what_is_logged_is_drawn(transition):
    sheet = figures.sheet(transition)
    for name, values in (
        ("speeds", transition["omega_rl"]),
        ("pressure", transition["p_mc"] / 1e5),
        ("deceleration", -transition["a_x"] / 9.80665),
    ):
        (ax,) = sheet.figure(name).axes
        assert drawn(ax, transition.time, values)


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


TIME = np.arange(200) / 100.0
COLUMNS = (
    WholeColumn("time", "s", TIME),
    *(WholeColumn(f"omega_f{side}", "rad/s", 50.0 - TIME) for side in "lr"),
    WholeColumn("omega_rl", "rpm", 500.0 - TIME),
    WholeColumn("Gang", None, np.full(200, np.nan)),
)
LOG = WholeLog("run", "here", "", COLUMNS)


def test_events_are_marked_in_every_panel():
    drawn = figure(LOG, (RunEvent(BITES, 0.5, 0.5), RunEvent(BRAKING, 0.5, 1.5)))
    assert len(drawn.axes) == 3
    for ax in drawn.axes:
        assert any(np.allclose(line.get_xdata(), 0.5) for line in ax.lines)
        assert ax.patches[0].get_x() == pytest.approx(0.5)
        assert ax.get_xlim() == (TIME[0], TIME[-1])
    assert {BITES, BRAKING} <= {*labels(drawn.axes[0])}


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
