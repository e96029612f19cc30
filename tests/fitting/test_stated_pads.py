"""The pads' ratio by the user: a fit takes it over with the uncertainty that the user gives."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.fitting.fit import fit
from calib.fitting.pads import DEFAULT_PRIOR, pad_ratio_prior
from calib.model.roller_bench import AxleOnRollers, RollerBench
from calib.table.table import Value
from tests.support.reference_car import CAR, REAL, noisy, ramp, with_ratio, without

RATIO = 1.1
"""Front pads 10 % better than the rear ones; the file says alike."""

PADS = {"front": 0.38 * math.sqrt(RATIO), "rear": 0.38 / math.sqrt(RATIO)}


def rollers(off):
    """Return forces noted in steps of 10 N, the front ones wrong by a relative ``off`` [1]."""
    pressures, rows = np.linspace(8e5, 48e5, 6), []
    for name, starts, scale in (("front", 0.3e5, 1.0 + off), ("rear", 0.6e5, 1.0)):
        axle = getattr(CAR, name)
        area = 2 * axle.friction_faces * axle.piston_area * axle.effective_radius
        force = scale * PADS[name] * area / axle.rolling_radius * (pressures - starts)
        shown = np.round(force, -1)
        rows.append(AxleOnRollers(tuple(pressures.tolist()), tuple(shown.tolist())))
    return RollerBench("rollers", "rollers.toml", "0" * 64, 0.01, *rows)


def tolerant(front, rear):
    return replace(
        CAR,
        front=replace(CAR.front, pad_friction_tolerance=front),
        rear=replace(CAR.rear, pad_friction_tolerance=rear),
    )


def test_tolerances_of_the_axles_are_independent_and_an_unsaid_one_is_that_of_a_grade():
    assert pad_ratio_prior(CAR, None) == DEFAULT_PRIOR
    assert pad_ratio_prior(tolerant(0.03, 0.04), None) == Value(0.0, pytest.approx(0.05))
    prior = pad_ratio_prior(tolerant(None, 0.01), None)
    assert prior == Value(0.0, pytest.approx(math.hypot(0.05, 0.01), rel=0.01))


def test_rollers_outrank_the_file():
    bench = rollers(0.0)
    assert pad_ratio_prior(tolerant(0.03, 0.03), bench) == bench.log_pad_ratio(CAR)


@pytest.fixture(scope="module")
def run():
    return noisy(ramp(with_ratio(REAL, RATIO)), 1)


@pytest.mark.parametrize("with_v", [True, False])
def test_rollers_of_one_percent_give_the_ratio_of_the_ramp(run, with_v):
    """The front forces are 1 % off, as much as the machine is known to."""
    bench = rollers(0.01)
    table = fit(CAR, [run if with_v else without(run, "v")], bench=bench)
    pads = table.calibration
    low, high = pads.pad_log_ratio.ci95
    assert pads.pad_log_ratio.value == pytest.approx(math.log(RATIO), abs=0.015)
    assert low < math.log(RATIO) < high
    assert high - low < 2.0 * 1.96 * 0.012
    for name, pad in (("front", pads.pad_friction_f), ("rear", pads.pad_friction_r)):
        assert pad.value == pytest.approx(PADS[name], rel=0.025)
        assert pad.ci95[0] < PADS[name] < pad.ci95[1]
    assert table.vehicle == CAR
    assert [(log.name, log.digest) for log in table.provenance.logs if log.role == "bench"] == [
        (bench.name, bench.digest)
    ]
    assert "pad_ratio" not in [warning.code for warning in table.warnings]


def test_a_tolerance_of_the_file_is_the_interval_of_a_ramp_that_tells_nothing(run):
    log = without(run, "v")
    sure, unsure = (fit(tolerant(s, s), [log]).calibration.pad_log_ratio for s in (0.01, 0.1))
    assert sure.sigma == pytest.approx(0.01 * math.sqrt(2.0), rel=0.05)
    assert abs(sure.value) < 0.02
    assert 0.05 < unsure.sigma < 0.1 * math.sqrt(2.0)
