import re

import pytest

from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import failures, kind_of, summarise
from tests.support.fleet_results import DRIFT_AT, OUTLIER, results


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


def look(found, name):
    return next(one for one in found.metrics if one.column.name == name)


def test_the_drift_is_found_where_it_is_and_only_there(found):
    pads = look(found, "pad_friction_f")
    assert pads.drifts
    assert abs(pads.rows[pads.change.first] - DRIFT_AT) <= 10
    assert pads.change.new_level - pads.change.old_level == pytest.approx(0.01, abs=0.004)
    assert not look(found, "settling").drifts
    assert (pads.values.size, pads.scale) == (397, pytest.approx(0.01, rel=0.1))


def test_the_outlier_is_named(found):
    worst = found.apart[0]
    (reason,) = worst.reasons
    assert worst.log == f"line/car{OUTLIER + 1}.csv"
    assert (reason.figure, reason.value) == ("pad_friction_f", 0.55)
    assert len(found.apart) <= 2


def test_statuses_shares_and_errors(found):
    assert found.status == {"passed": 397, "error": 3}
    assert found.classes == {
        "usable": {"yes": 300, "no": 100},
        "verdict": {"no_gap": 266, "named": 134},
    }
    (failure,) = found.failures
    assert re.fullmatch(r"line/car\d+\.csv: <b>ends</b> at [\d.]+ s", failure.message)
    assert failure.count == 3


@pytest.mark.parametrize("unknown", [0, 3])
def test_the_column_that_orders_the_line_does_not_drift(tmp_path, unknown):
    import pyarrow as pa

    number = [None] * unknown + [float(i) for i in range(40 - unknown)]
    extra = {"number": (number, pa.float64(), "1")}
    fleet = open_fleet(results(tmp_path / "r.parquet", 40, extra=extra), "number")
    assert not look(summarise(fleet), "number").drifts


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
