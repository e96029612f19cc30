from dataclasses import replace

import numpy as np
import pytest

from calib.fitting.fit import fit
from calib.logs.read import read_log
from calib.physics.vehicle_file import read_vehicle
from calib.plots.measured import GROUP, grouped, measure
from tests.plots.conftest import SIMULATION


@pytest.fixture(scope="module")
def run():
    return read_log(SIMULATION / "ramp_noisy.parquet")


@pytest.fixture(scope="module")
def table(run):
    return fit(read_vehicle(SIMULATION / "vehicle.toml"), [run])


def test_forces_are_the_true_ones(table, run):
    found = measure(table, run)
    at = np.searchsorted(run.time, found.time - 0.025)  # the middle of each block
    z = found.z
    weight = 1744.0 * 9.80665
    loads = {"f": weight * (1.6494 + 0.615 * z) / 2.805, "r": weight * (1.1556 - 0.615 * z) / 2.805}
    hard = found.braked & (z > 0.15)
    # the rear carries the error of the pad ratio, which the ramp knows to about 2 %
    for axle, F, tolerance in (("f", found.F_f, 0.02), ("r", found.F_r, 0.04)):
        true = (run.truth[f"true_Fx_{axle}l"] + run.truth[f"true_Fx_{axle}r"])[at] / loads[axle]
        assert F[hard] == pytest.approx(true[hard], rel=tolerance)


def test_f1_and_f2_satisfy_18(table, run):
    found = measure(table, run)
    front = 1.6494 + 0.615 * found.z
    rear = 1.1556 - 0.615 * found.z
    assert found.f1 * front == pytest.approx(-found.f2 * rear)
    assert found.f1 - found.f2 == pytest.approx(found.F_f - found.F_r)


def test_what_is_measured_lies_around_what_the_model_says(table, run):
    found = measure(table, run)
    gap = (found.eta - found.eta_model)[found.braked]
    assert abs(np.mean(gap)) < 1e-4  # a fiftieth of the signal
    curve = np.interp(found.slip_f, table.tyre.slip, table.tyre.force)
    hard = found.braked & (found.z > 0.15)
    assert np.mean((curve - found.F_f)[hard]) == pytest.approx(0.0, abs=0.005)


def test_without_v_there_is_no_slip(table, run):
    channels = {name: x for name, x in run.channels.items() if name != "v"}
    found = measure(table, replace(run, channels=channels))
    assert found.slip_f is None
    assert found.slip_r is None


def test_a_group_is_the_mean_of_its_blocks():
    values = np.arange(2.0 * GROUP + 3.0)
    mask = np.ones(values.size, bool)
    assert list(grouped(values, mask)) == [(GROUP - 1) / 2, (3 * GROUP - 1) / 2]
    assert grouped(values, ~mask).size == 0
