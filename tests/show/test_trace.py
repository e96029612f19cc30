import numpy as np
import pytest

from calib.car.vehicle_file import read_vehicle
from calib.estimation.results import write_result
from calib.estimation.validate import validate
from calib.show.result import read_result
from calib.show.trace import from_result
from tests.show.conftest import SEDAN, traced
from tests.support.stored_results import made_result


def test_nominal_torque_is_that_of_table_1_at_the_pressure(sedan, transition):
    car = read_vehicle(SEDAN / "vehicle.toml")
    found = traced(sedan, transition, car)
    p = np.maximum(transition["p_mc"], 0.0)
    per_wheel = 0.38 * 2 * 28.84e-4 * 0.1309 * p
    assert found.front.nominal == 0.38
    assert found.front.nominal_torque == pytest.approx(2.0 * per_wheel)


def test_a_simulation_knows_its_pads(simulated):
    assert simulated.has_truth
    for axle, nominal in ((simulated.front, 0.5), (simulated.rear, 0.6)):
        assert axle.nominal == nominal
        # the paper's Section IV: 0.4; the pressure is noisy
        assert np.mean(axle.true_pad[simulated.valid]) == pytest.approx(0.4, rel=0.01)
        assert np.isnan(axle.true_pad[0])


def test_a_vehicle_adds_nominal_pads():
    car = read_vehicle(SEDAN / "vehicle.toml")
    found = from_result(made_result(), car)
    assert found.front.nominal == 0.38
    assert found.front.nominal_torque == pytest.approx(np.full(40, 200.0 * 0.38 / 0.4))


def test_what_validate_writes_is_what_is_drawn(sedan, transition, trace, tmp_path):
    (validated,) = validate(sedan, [transition])
    write_result(validated.estimate, tmp_path / "stop.parquet")
    found = from_result(read_result(tmp_path / "stop.parquet"))
    for name in ("pad", "lower", "upper", "torque", "force"):
        a, b = getattr(found.rear, name), getattr(trace.rear, name)
        assert np.array_equal(a, b, equal_nan=True), name
    assert np.array_equal(found.valid, trace.valid)


def test_each_sample_is_valid_or_has_a_reason(trace):
    reasons = np.any(list(trace.refused.values()), axis=0)
    assert np.array_equal(reasons, ~trace.valid)
