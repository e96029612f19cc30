"""The brakes of a vehicle file."""

import numpy as np
import pytest

from calib.plots.vehicle import sheet
from tests.support.tables import VEHICLE


def test_the_lines_meet_where_the_bias_turns():
    drawn = sheet(VEHICLE).overview()
    brakes, used = drawn.axes
    by_label = {line.get_label(): line for line in brakes.lines}
    at = by_label["front locks first up to 0.64 g"].get_xydata()[0]
    ideal = by_label["ideal: both axles use the same friction"].get_xydata()
    assert np.interp(at[0], *ideal.T) == pytest.approx(at[1], rel=1e-3)
    front, rear, _ = used.lines
    cross = np.argmin(np.abs(front.get_ydata() - rear.get_ydata())[20:]) + 20
    assert front.get_xdata()[cross] == pytest.approx(0.641, abs=0.01)
