import re

import numpy as np
import pytest

from calib.base.errors import InputError
from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import failures, kind_of, summarise
from tests.support.fleet_results import DRIFT_AT, OUTLIER, results


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


def look(found, name):
    return next(one for one in found.looks if one.column.name == name)


def test_the_drift_is_found_where_it_is_and_only_there(found):
    pads = look(found, "pad_friction_f")
    assert pads.drifts
    assert abs(pads.rows[pads.change.first] - DRIFT_AT) <= 10
    assert pads.change.new_level - pads.change.old_level == pytest.approx(0.01, abs=0.004)
    assert not look(found, "settling").drifts
    assert (pads.values.size, pads.scale) == (397, pytest.approx(0.01, rel=0.1))


def test_the_outlier_is_named(found):
    worst = found.outliers[0]
    assert (worst.log, worst.figure, worst.value) == (
        f"line/car{OUTLIER + 1}.csv", "pad_friction_f", 0.55)  # fmt: skip
    assert len(found.outliers) <= 2


def test_statuses_shares_and_errors(found):
    assert found.status == {"passed": 397, "error": 3}
    assert found.classes == {
        "usable": {"yes": 300, "no": 100},
        "verdict": {"no_gap": 266, "named": 134},
    }
    (failure,) = found.failures
    assert re.fullmatch(r"line/car\d+\.csv: <b>ends</b> at [\d.]+ s", failure.message)
    assert failure.count == 3


def test_drift_is_tested_where_a_plain_step_would_be_found(tmp_path):
    import pyarrow as pa

    # p of a plain step: 0.011 of 15 logs, 0.0071 of 16; one among five figures needs 0.002
    for n, figures, tested in ((15, 1, False), (16, 1, True), (16, 5, False), (30, 5, True)):
        step = np.where(np.arange(n) < n // 2, 0.0, 1.0) + 1e-6 * np.arange(n)
        noise = np.random.default_rng(n).normal(size=(figures - 1, n))
        extra = {f"x{i}": (list(x), pa.float64(), "1") for i, x in enumerate([step, *noise])}
        fleet = open_fleet(results(tmp_path / f"{n}_{figures}.parquet", n, extra=extra))
        seen = look(summarise(fleet, tuple(extra)), "x0")
        assert (seen.change is not None) == tested
        assert seen.drifts == tested


@pytest.mark.parametrize("unknown", [0, 3])
def test_the_column_that_orders_the_line_does_not_drift(tmp_path, unknown):
    import pyarrow as pa

    number = [None] * unknown + [float(i) for i in range(40 - unknown)]
    extra = {"number": (number, pa.float64(), "1")}
    fleet = open_fleet(results(tmp_path / "r.parquet", 40, extra=extra), "number")
    assert not look(summarise(fleet), "number").drifts


def test_only_what_is_wanted(tmp_path):
    fleet = open_fleet(results(tmp_path / "r.parquet", 12))
    assert [one.column.name for one in summarise(fleet, ("settling",)).looks] == ["settling"]
    with pytest.raises(InputError):
        summarise(fleet, ("setling",))


def test_errors_of_one_kind_meet():
    errors = (
        "a/run1.csv: ends at 3.2 s",
        "a/run2.csv: ends at 11 s",
        None,
        "no channel p_mc in run4",
    )
    logs = tuple(f"a/run{i}.csv" for i in range(1, 5))
    assert [(f.message, f.count) for f in failures(logs, errors)] == [
        ("a/run1.csv: ends at 3.2 s", 2),
        ("no channel p_mc in run4", 1),
    ]
    assert kind_of("omega_fl3 reads -2.5e-3 rad/s", "x.csv") == "omega_fl3 reads # rad/s"
