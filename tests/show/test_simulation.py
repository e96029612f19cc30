import numpy as np
import pytest

from calib.show import simulation, stop
from calib.show.style import FRONT, REAR
from tests.support.plot_lines import axes, line


def test_the_page_has_figures_9_to_11_and_the_stop_by_name(simulated):
    sheet = simulation.sheet(simulated)
    assert [name for row in sheet.rows for name in row] == [
        "compensation-front",
        "compensation-rear",
        "torque-front-left",
        "torque-rear-left",
        "error-front-left",
        "error-rear-left",
    ]
    assert {"wheel-speeds", "slip", "force-sum"} <= {*sheet.names}


def test_compensation_shows_truth_nominal_law_and_estimate(simulated):
    ax = axes()
    stop.pad(ax, simulated, simulated.rear, REAR, simulation.METHODS)
    law = line(ax, r"gradient law on $D(\eta)$")[1]
    valid = simulated.valid
    assert np.array_equal(law[valid], simulated.rear.baselines["gradient_difference"][valid])
    assert np.isnan(law[~valid]).all()
    assert line(ax, r"$\mu_{p,n}$ of the vehicle file")[1] == [0.6, 0.6]
    truth = line(ax, "truth")[1][simulated.valid]
    assert truth == pytest.approx(np.full(truth.size, 0.4), rel=0.02)
    low, high = ax.get_ylim()
    assert low < 0.4 < 0.6 < high


def test_error_is_relative_and_only_where_valid(simulated):
    found = simulation.relative(1.05 * np.ones(3), np.array([1.0, 0.0, 1.0]), _three(simulated))
    assert found[0] == pytest.approx(5.0)
    assert np.isnan(found[1:]).all()
    ax = axes()
    simulation.error(ax, simulated, simulated.front, FRONT)
    nominal = line(ax, "uncompensated")[1]
    # 0.5 where 0.4 is true
    assert nominal[simulated.valid] == pytest.approx(np.full(simulated.valid.sum(), 25.0), abs=1.0)
    assert np.isnan(nominal[~simulated.valid]).all()


def _three(trace):
    from dataclasses import replace

    return replace(trace, time=np.arange(3.0), valid=np.array([True, True, False]))
