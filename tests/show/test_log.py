"""All columns of a log in one picture."""

from dataclasses import replace

import numpy as np
import pytest

from calib.logs.whole import WholeColumn, WholeLog
from calib.run.events import BITES, BRAKING, RunEvent
from calib.show import log
from calib.show.log import MAX_PANELS, log_sheet
from tests.support.plot_lines import line, panel


def test_the_channels_of_a_log_are_drawn_with_raw_eta(transition):
    drawn = log_sheet(log.whole_of(transition))
    assert drawn.names == ("p_mc", "a_x", "omega", "v", "eta")
    assert np.array_equal(line(panel(drawn, "omega"), "rl")[1], transition["omega_rl"])
    assert line(panel(drawn, "p_mc"), "")[1] == pytest.approx(transition["p_mc"] / 1e5)
    rear = transition["omega_rl"] + transition["omega_rr"]
    front = transition["omega_fl"] + transition["omega_fr"]
    (eta,) = panel(drawn, "eta").lines
    assert eta.y[0] == pytest.approx(100.0 * (rear / front - 1.0)[0])


def test_eta_ends_where_the_car_stands_and_needs_every_wheel(transition):
    spins = {f"omega_{w}": np.zeros(transition.time.size) for w in ("fl", "fr", "rl", "rr")}
    standing = replace(transition, channels=transition.channels | spins)
    (eta,) = panel(log_sheet(log.whole_of(standing)), "eta").lines
    assert np.isnan(eta.y).all()
    spins.pop("omega_rl")
    part = replace(transition, channels={"time": transition.time, **spins})
    assert log_sheet(log.whole_of(part)).names == ("omega",)


TIME = np.arange(200) / 100.0
COLUMNS = (
    WholeColumn("time", "s", TIME),
    *(WholeColumn(f"omega_f{side}", "rad/s", 50.0 - TIME) for side in "lr"),
    WholeColumn("omega_rl", "rpm", 500.0 - TIME),
    WholeColumn("Gang", None, np.full(200, np.nan)),
)
LOG = WholeLog("run", "here", "", COLUMNS)


def test_events_are_marked_in_every_panel():
    drawn = log_sheet(LOG, (RunEvent(BITES, 0.5, 0.5), RunEvent(BRAKING, 0.5, 1.5)))
    assert drawn.names == ("omega", "omega [rpm]", "Gang")
    for shown_panel in drawn.panels:
        assert [(mark.start, mark.end) for mark in shown_panel.marks] == [(0.5, 0.5), (0.5, 1.5)]
        assert shown_panel.xlim == (TIME[0], TIME[-1])
    assert [mark.label for mark in drawn.panels[0].marks] == [BITES, BRAKING]


def test_too_many_columns_are_refused():
    many = tuple(WholeColumn(f"x{i}", "bar", TIME) for i in range(MAX_PANELS + 1))
    with pytest.raises(ValueError, match=f"at most {MAX_PANELS}"):
        log_sheet(WholeLog("run", "here", "", (COLUMNS[0], *many)))
