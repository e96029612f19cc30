"""Differences of two tables against closed forms; one fit is one table on every processor."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.run.same_run import fingerprint_of
from calib.table.compare import TOLERANCE, diff, inputs_digest, is_same_fit
from tests.support.made_runs import made_run
from tests.support.tables import made_table

ROOT = Path(__file__).parents[2]


def gap_of(difference, curve):
    return next(gap for gap in difference.curves if gap.curve == curve)


def test_a_table_differs_in_nothing_from_itself(table):
    difference = diff(table, made_table())
    assert difference.identical
    names = ("D", "f1", "f2", "g", "map ratio", "map change")
    assert [(g.curve, g.in_bands) for g in difference.curves[:6]] == [(x, 0.0) for x in names]
    assert not any(g.in_bands for g in difference.curves)


@given(st.floats(20.0, 40.0), st.floats(20.0, 40.0), st.integers(5, 60), st.integers(5, 60))
def test_stiffness_gap_is_its_closed_form(first, second, rows_a, rows_b):
    # D = C (eta - 1): the gap is (C_b - C_a) (eta - 1), largest where eta - 1 ends, at 0.005
    # half of the band is 2 (eta - 1) in both tables
    gap = gap_of(diff(made_table(first, rows=rows_a), made_table(second, rows=rows_b)), "D")
    assert gap.largest == pytest.approx((second - first) * 0.005, abs=1e-12)
    assert gap.in_bands == pytest.approx(abs(second - first) / np.sqrt(8.0), rel=1e-6, abs=1e-9)


def test_only_the_common_axis_counts(table):
    near, far = (
        diff(table, replace(table, tyre=replace(table.tyre, slip=table.tyre.slip + shift)))
        for shift in (0.004, 0.02)
    )
    gap = gap_of(near, "g")
    assert (gap.start, gap.end) == pytest.approx((0.004, 0.01))
    assert gap.largest == pytest.approx(-27.0 * 0.004)
    assert far.apart == ("g",)
    assert not far.identical


# One fit on two kinds of computer

FIT = """
import sys
import calib
logs = calib.sample_logs() / sys.argv[2]
car = calib.read_vehicle(logs / "vehicle.toml")
stored = calib.Store(sys.argv[1]).save(calib.fit(car, [calib.read_log(logs / sys.argv[3])]))
print(stored.id, stored.existed)
"""


def test_the_same_logs_give_the_same_version_on_other_processors(tmp_path):
    printed = []
    for kind in ("Prescott", "Haswell"):
        process = subprocess.run(
            [sys.executable, "-c", FIT, str(tmp_path), "sedan", "ramp_wet_asphalt.csv"],
            env={**os.environ, "OPENBLAS_CORETYPE": kind},
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )
        if process.returncode < 0:
            pytest.skip(f"this processor cannot run the code of a {kind}")
        printed.append(process.stdout.split())
    assert [existed for _, existed in printed] == ["False", "True"]
    assert len({name for name, _ in printed}) == 1


@given(st.floats(-1.0, 1.0), st.integers(0, 20))
def test_numbers_may_differ_by_rounding_and_by_no_more(share, row):
    table = made_table()
    largest = np.abs(table.paper.f1).max()

    def moved(share_of_largest):
        f1 = table.paper.f1.copy()
        f1[row] += share_of_largest * largest
        return replace(table, paper=replace(table.paper, f1=f1))

    assert is_same_fit(table, moved(0.5 * share * TOLERANCE))
    assert not is_same_fit(table, moved(np.copysign(2.0 * TOLERANCE, share)))


def test_a_value_near_zero_is_measured_by_its_sigma():
    table = made_table()
    pads = table.calibration

    def with_ratio(value):
        ratio = replace(pads.pad_log_ratio, value=value)
        return replace(table, calibration=replace(pads, pad_log_ratio=ratio))

    sigma = pads.pad_log_ratio.sigma
    assert is_same_fit(with_ratio(1e-9), with_ratio(-1e-9))
    assert not is_same_fit(with_ratio(1e-9), with_ratio(0.1 * sigma))


def test_other_inputs_are_another_table():
    table = made_table()
    heavier = replace(table, vehicle=replace(table.vehicle, mass=1744.0 + 1e-9))
    other = replace(table.provenance, settings={**table.provenance.settings, "block": 0.1})
    assert not is_same_fit(table, heavier)
    assert not is_same_fit(table, replace(table, provenance=other))
    assert inputs_digest(table.content()[0]) != inputs_digest(heavier.content()[0])


def test_numbers_of_a_fingerprint_follow_from_the_log():
    """Rounded fingerprints leave a table the same; a table without a fingerprint is another."""
    table = made_table()

    def with_fingerprints(*prints):
        pairs = zip(table.provenance.logs, prints, strict=True)
        logs = tuple(replace(log, fingerprint=fingerprint) for log, fingerprint in pairs)
        return replace(table, provenance=replace(table.provenance, logs=logs))

    first, second = (fingerprint_of(made_run(noise=noise)) for noise in (1.0, 2.0))
    assert is_same_fit(with_fingerprints(first, None), with_fingerprints(second, None))
    assert not is_same_fit(with_fingerprints(first, None), table)
    assert "fingerprint" not in str(table.content()[0])
