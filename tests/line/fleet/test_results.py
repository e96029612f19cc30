"""Read `results.parquet`: columns with kind and unit, order of the logs, files that are refused."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.base.errors import InputError
from calib.line.fleet.results import open_fleet
from calib.line.fleet.rows import Column
from tests.support.fleet_results import LOST, results


def test_metrics_with_kind_and_unit(tmp_path):
    fleet = open_fleet(results(tmp_path / "r.parquet"))
    assert fleet.metrics == (
        Column("pad_friction_f", "1", float),
        Column("settling", "s", float),
        Column("built", "s", float),
        Column("usable", "1", bool),
        Column("verdict", "1", str),
    )
    assert np.flatnonzero(np.isnan(fleet.numbers("pad_friction_f"))).tolist() == list(LOST)


def test_the_line_is_in_the_natural_order_of_names(tmp_path):
    path = results(tmp_path / "r.parquet", 12)
    fleet = open_fleet(path)
    assert fleet.logs[1:3] == ("line/car2.csv", "line/car3.csv")
    assert fleet.logs[-1] == "line/car12.csv"
    assert fleet.numbers("built").tolist() == list(range(12, 0, -1))


def test_what_is_no_results_file_is_refused(tmp_path):
    path = tmp_path / "r.parquet"
    with pytest.raises(InputError):
        open_fleet(path)
    path.write_bytes(results(tmp_path / "whole.parquet").read_bytes()[:500])
    with pytest.raises(InputError):
        open_fleet(path)
    pq.write_table(pa.table({"log": ["a"], "status": ["passed"]}), path)
    with pytest.raises(InputError):
        open_fleet(path)
    strange = {"status": (["fine"] * 5, pa.string(), None)}
    with pytest.raises(InputError):
        open_fleet(results(path, 5, extra=strange))
    pq.write_table(pq.read_table(results(path, 5)).slice(0, 0), path)
    with pytest.raises(InputError):
        open_fleet(path)
