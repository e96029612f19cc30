from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.vehicle_file import read_vehicle
from calib.estimation.limits import Limit
from calib.estimation.results import write_result
from calib.estimation.validate import validate, validate_one
from calib.show.judged import broken, word
from calib.show.result import read_result
from calib.show.trace import from_result
from tests.show.conftest import SEDAN, traced
from tests.support.stored_results import made_result

WEIGHT = 1744.0 * 9.80665


def test_the_sum_of_forces_is_that_of_the_deceleration(trace):
    """(18) makes it so for any table; air drag is part of what slows the car."""
    held = trace.valid
    assert np.mean(trace.force_sum[held]) == pytest.approx(np.mean(trace.inertia[held]), rel=0.02)
    assert trace.inertia == pytest.approx(WEIGHT * trace.z)


def test_what_a_term_takes_is_in_the_sum_of_forces(sedan, transition):
    """Two hundredths of the weight, 5 % of what slows the car, which was weighed to 0.5 %.

    With a mass that is open by 3 %, pads at 0.96 of nominal may as well be nominal.
    """
    term = EmpiricalTerm("body", "constant", (0.0,), (0.02,))
    car = replace(sedan.vehicle, effects=Effects(terms=(term,)), mass_tolerance=0.005)
    table = replace(sedan, vehicle=car)
    drawn = traced(table, transition)
    held = drawn.valid
    assert np.mean(drawn.force_sum[held]) == pytest.approx(np.mean(drawn.inertia[held]), rel=0.02)


def test_nominal_torque_is_that_of_table_1_at_the_pressure(sedan, transition):
    car = read_vehicle(SEDAN / "vehicle.toml")
    found = traced(sedan, transition, car)
    p = np.maximum(transition["p_mc"], 0.0)
    per_wheel = 0.38 * 2 * 28.84e-4 * 0.1309 * p
    assert found.front.nominal == 0.38
    assert found.front.nominal_torque == pytest.approx(2.0 * per_wheel)
    # what nominal pads brake more, in forces at the road
    excess = (found.front.nominal_torque - found.front.torque) / 0.322
    excess += (found.rear.nominal_torque - found.rear.torque) / 0.322
    held = found.valid
    gap = found.force_sum_nominal - found.force_sum
    assert gap[held] == pytest.approx(excess[held])


def test_a_simulation_knows_its_pads(simulated):
    assert simulated.has_truth
    for axle, nominal in ((simulated.front, 0.5), (simulated.rear, 0.6)):
        assert axle.nominal == nominal
        # the paper's Section IV: 0.4; the pressure is noisy
        assert np.mean(axle.true_pad[simulated.valid]) == pytest.approx(0.4, rel=0.01)
        assert np.isnan(axle.true_pad[0])


def test_a_vehicle_adds_nominal_pads_and_the_sum():
    car = read_vehicle(SEDAN / "vehicle.toml")
    found = from_result(made_result(), car)
    assert found.front.nominal == 0.38
    assert found.front.nominal_torque == pytest.approx(np.full(40, 200.0 * 0.38 / 0.4))
    assert found.force_sum == pytest.approx(np.full(40, 0.4 * WEIGHT))  # F = 0.4 on both axles
    assert found.force_sum_nominal == pytest.approx(found.force_sum - 2 * 10.0 / 0.322)


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


def test_the_verdict_is_that_of_the_validation(sedan, transition, trace):
    assert trace.verdict.startswith("passed")
    strict = (Limit("interval_f", None, 0.01), Limit("valid_share", 0.5, None))
    failed = validate_one(sedan, transition, None, strict, baselines=False)
    (told,) = broken(failed)
    assert "interval_f" in told
    assert word(failed).startswith("failed")
