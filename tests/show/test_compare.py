import numpy as np

from calib.show import compare
from tests.support.plot_lines import line, panel
from tests.support.tables import made_table

FIRST, SECOND = made_table(), made_table(28.0, rows=31)


def test_both_tables_are_drawn_pads_first():
    sheet = compare.sheet(FIRST, SECOND, "sedan@1", "sedan@2")
    assert sheet.names == ("pads", "map", "f1-f2")
    pads = SECOND.calibration.pad_friction_r
    assert line(panel(sheet, "pads"), "rear, sedan@2")[1] == [pads.value]
    curves = panel(sheet, "f1-f2")
    assert np.array_equal(line(curves, "f1, sedan@1")[1], FIRST.paper.f1)
    assert np.array_equal(line(curves, "f2, sedan@2")[1], SECOND.paper.f2)
    assert all(one.band for one in curves.lines)


def test_the_maps_of_both_are_drawn(sedan):
    drawn = panel(compare.sheet(sedan, sedan, "sedan@1", "sedan@2"), "map")
    first, second = (line(drawn, name) for name in ("sedan@1", "sedan@2"))
    assert np.array_equal(first, second)
