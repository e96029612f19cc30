import numpy as np

from calib.plots import ramp as figures
from calib.plots.measured import measure
from calib.plots.style import FRONT
from tests.support.plot_lines import axes, drawn, labels, line


def test_pressure_is_drawn_in_bar(sedan, ramp):
    ax, run = axes(), measure(sedan, ramp)
    figures.pressure(ax, run)
    x, y = line(ax, "greater of the axles' pressures")
    assert np.array_equal(x, run.time)
    # 40 bar at the end of this ramp, see the file
    assert y[-1] == np.float64(run.pressure[-1] / 1e5)
    assert 35.0 < y.max() < 45.0


def test_forces_are_those_measured_with_the_deceleration_between(sedan, ramp):
    ax, run = axes(), measure(sedan, ramp)
    figures.forces(ax, run)
    assert labels(ax) == ["front $F_f$", "$z$ as measured", "rear $F_r$", "$z$ less air drag"]
    for values in (run.F_f, run.F_r, run.z, run.carried):
        assert drawn(ax, run.time, values)
    late = run.time > 3.0
    middle = line(ax, "$z$ less air drag")[1][late]
    assert np.all(line(ax, "front $F_f$")[1][late] > middle)
    assert np.all(line(ax, "rear $F_r$")[1][late] < middle)


def test_points_are_the_blocks_of_the_mask(sedan, ramp):
    ax, run = axes(), measure(sedan, ramp)
    figures.points(ax, run, run.eta, run.f1, run.braked, FRONT, "measured")
    assert drawn(ax, run.eta[run.braked], run.f1[run.braked])
    x, _ = line(ax, "measured")
    assert x.size == run.braked.sum() // 5
