"""The bars are the parts of the budgets, largest first, and all of them on top."""

import numpy as np
import pytest

from calib.plots.budget import bars
from calib.plots.table import sheet
from calib.table.budget import AxleBudget
from tests.support.plot_lines import axes
from tests.support.tables import made_table

FRONT = AxleBudget(0.40, {"zeros": 1e-6, "mass": 9e-4})
REAR = AxleBudget(0.38, {"unlike_pads": 16e-4, "mass": 9e-4})


def drawn():
    ax = axes()
    bars(ax, (FRONT, REAR))
    return ax, {c.get_label(): [bar.get_width() for bar in c] for c in ax.containers}


def test_a_bar_is_as_long_as_its_part():
    ax, widths = drawn()
    assert [label.get_text() for label in ax.get_yticklabels()] == [
        *("all", "unlike pads", "mass", "zeros"),
    ]
    assert widths["front"] == pytest.approx([100.0 * np.sqrt(9.01e-4), 0.0, 3.0, 0.1])
    assert widths["rear"] == pytest.approx([5.0, 4.0, 3.0, 0.0])


def test_the_numbers_stand_beside_the_longer_bar_and_inside_the_axes():
    ax, widths = drawn()
    assert [text.get_text() for text in ax.texts] == [
        *(" 3.0 / 5.0", " 0.0 / 4.0", " 3.0 / 3.0", " 0.1 / 0.0"),
    ]
    assert [text.get_position()[0] for text in ax.texts] == pytest.approx([5.0, 4.0, 3.0, 0.1])
    assert ax.get_xlim()[1] > max(max(x) for x in widths.values())


def test_a_table_of_before_draws_what_it_knows():
    figure = sheet(made_table(), "sedan@1").figure("budget")
    names = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert names == ["all", "ramp"]
