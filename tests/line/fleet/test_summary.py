"""The summary of made results: the outlier, the statuses, and the errors by kind."""

import re

import pytest

from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import failures_of, kind_of, summarise
from tests.support.fleet_results import OUTLIER, results


@pytest.fixture(scope="module")
def summary(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


def test_the_outlier_is_named(summary):
    log, (reason,) = next(iter(summary.outliers.items()))
    assert log == reason.log == f"line/car{OUTLIER + 1}.csv"
    assert (reason.figure, reason.value) == ("pad_friction_f", 0.55)
    assert len(summary.outliers) <= 2


def test_statuses_shares_and_errors(summary):
    assert summary.status == {"passed": 397, "error": 3}
    pads = next(metric for metric in summary.metrics if metric.column.name == "pad_friction_f")
    assert (pads.values.size, pads.scale) == (397, pytest.approx(0.01, rel=0.1))
    (failure,) = summary.failures
    assert re.fullmatch(r"line/car\d+\.csv: <b>ends</b> at [\d.]+ s", failure.message)
    assert failure.count == 3


def test_errors_of_one_kind_meet():
    errors = (
        "a/run1.csv: ends at 3.2 s",
        "a/run2.csv: ends at 11 s",
        None,
        "no channel p_mc in run4",
    )
    logs = tuple(f"a/run{i}.csv" for i in range(1, 5))
    assert [(f.message, f.count) for f in failures_of(logs, errors)] == [
        ("a/run1.csv: ends at 3.2 s", 2),
        ("no channel p_mc in run4", 1),
    ]
    assert kind_of("omega_fl3 reads -2.5e-3 rad/s", "x.csv") == "omega_fl3 reads # rad/s"
