"""One fit is one table on every kind of processor."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.run.fingerprint import fingerprint_of
from calib.table.compare import TOLERANCE, inputs, same
from tests.support.made_runs import made_run
from tests.support.tables import made_table

ROOT = Path(__file__).parents[2]

FIT = """
import sys
import calib
logs = calib.sample_logs() / sys.argv[2]
car = calib.read_vehicle(logs / "vehicle.toml")
stored = calib.Store(sys.argv[1]).save(calib.fit(car, [calib.read_log(logs / sys.argv[3])]))
print(stored.id, stored.existed)
"""


@pytest.mark.parametrize(
    ("folder", "ramp"),
    [("sedan", "ramp_wet_asphalt.csv"), ("simulation_study", "ramp_noisy.parquet")],
)
def test_the_same_logs_give_the_same_version_on_other_processors(tmp_path, folder, ramp):
    said = []
    for kind in ("Prescott", "Haswell", "SkylakeX"):
        ran = subprocess.run(
            [sys.executable, "-c", FIT, str(tmp_path), folder, ramp],
            env={**os.environ, "OPENBLAS_CORETYPE": kind},
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )
        if ran.returncode < 0:
            pytest.skip(f"this processor cannot run the code of a {kind}")
        said.append(ran.stdout.split())
    assert [existed for _, existed in said] == ["False", "True", "True"]
    assert len({name for name, _ in said}) == 1


@given(st.floats(-1.0, 1.0), st.integers(0, 20))
def test_numbers_may_differ_by_rounding_and_by_no_more(share, row):
    table = made_table()
    largest = np.abs(table.paper.f1).max()

    def moved(by):
        f1 = table.paper.f1.copy()
        f1[row] += by * largest
        return replace(table, paper=replace(table.paper, f1=f1))

    assert same(table, moved(0.5 * share * TOLERANCE))
    assert not same(table, moved(np.copysign(2.0 * TOLERANCE, share)))


def test_a_value_near_zero_is_measured_by_its_sigma():
    table = made_table()
    pads = table.calibration

    def with_ratio(value):
        ratio = replace(pads.pad_log_ratio, value=value)
        return replace(table, calibration=replace(pads, pad_log_ratio=ratio))

    sigma = pads.pad_log_ratio.sigma
    assert same(with_ratio(1e-9), with_ratio(-1e-9))
    assert not same(with_ratio(1e-9), with_ratio(0.1 * sigma))


def test_other_inputs_are_another_table():
    table = made_table()
    heavier = replace(table, vehicle=replace(table.vehicle, mass=1744.0 + 1e-9))
    other = replace(table.provenance, settings={**table.provenance.settings, "block": 0.1})
    assert not same(table, heavier)
    assert not same(table, replace(table, provenance=other))
    assert inputs(table.content()[0]) != inputs(heavier.content()[0])


def test_numbers_of_a_fingerprint_follow_from_the_log():
    """They may be rounded in another way; a table without one is another table."""
    table = made_table()

    def with_fingerprints(*prints):
        logs = tuple(
            replace(log, fingerprint=one)
            for log, one in zip(table.provenance.logs, prints, strict=True)
        )
        return replace(table, provenance=replace(table.provenance, logs=logs))

    one, other = (fingerprint_of(made_run(noise=noise)) for noise in (1.0, 2.0))
    assert same(with_fingerprints(one, None), with_fingerprints(other, None))
    assert not same(with_fingerprints(one, None), table)
    assert "fingerprint" not in str(table.content()[0])
