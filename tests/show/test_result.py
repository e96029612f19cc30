import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.base.errors import InputError
from calib.show.result import COLUMNS, is_result, read_result


def write_result(path, **changes):
    columns = {name: np.linspace(0.1, 1.0, 50) + i for i, name in enumerate(COLUMNS)}
    columns["ecu_valid"] = np.arange(50) % 2 == 0
    columns |= dict.fromkeys(("valid", "pad_friction_f", "pad_friction_r"), columns["ecu_valid"])
    columns |= changes
    pq.write_table(pa.table({k: v for k, v in columns.items() if v is not None}), path)
    return columns


def test_a_result_is_read_as_written(tmp_path):
    path = tmp_path / "stop.parquet"
    columns = write_result(path)
    assert is_result(path)
    result = read_result(path)
    assert result.name == "stop"
    for name in COLUMNS:
        assert np.array_equal(result.values[name], columns[name])
    assert np.array_equal(result.valid, columns["ecu_valid"])


def test_a_log_or_rubbish_is_no_result(tmp_path):
    log = tmp_path / "log.parquet"
    pq.write_table(pa.table({"time": [0.0, 1.0], "p_mc": [0.0, 1.0]}), log)
    (tmp_path / "rubbish.parquet").write_bytes(b"PAR1 and no more")
    (tmp_path / "log.csv").write_text("time [s],valid,pad_friction_f,pad_friction_r\n")
    for name in ("log.parquet", "rubbish.parquet", "log.csv", "missing.parquet"):
        assert not is_result(tmp_path / name)


def test_a_missing_column_is_named(tmp_path):
    write_result(tmp_path / "a.parquet", ecu_brake_torque_rl=None)
    with pytest.raises(InputError, match="no column ecu_brake_torque_rl"):
        read_result(tmp_path / "a.parquet")
