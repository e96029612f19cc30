"""Parquet: units from the field metadata."""

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.base.errors import LogError
from calib.logs.parquet import open_parquet
from calib.logs.source import Column


def parquet(fields, columns):
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table(columns, schema=pa.schema(fields)), sink)
    return sink.getvalue().to_pybytes()


TIME = pa.field("time", pa.float64(), metadata={"unit": "s"})
PRESSURE = pa.field("p_mc", pa.int32(), metadata={"unit": "kPa"})


def test_unit_comes_from_the_metadata():
    source = open_parquet(parquet([TIME, PRESSURE], [[0.0, 0.1], [5, None]]), "run.parquet")
    assert source.columns == (Column("time", "s"), Column("p_mc", "kPa"))
    (pressure,) = source.read([1])
    assert pressure[0] == 5.0
    assert pressure[1] != pressure[1]  # a null is no value


def test_unit_in_the_name_when_there_is_no_metadata():
    data = parquet([pa.field("p_mc [bar]", pa.float32())], [[1.0]])
    assert open_parquet(data, "run.parquet").columns == (Column("p_mc", "bar"),)


def test_text_column():
    source = open_parquet(parquet([pa.field("p_mc", pa.string())], [["open"]]), "run.parquet")
    with pytest.raises(LogError, match=r"run\.parquet: p_mc: holds string"):
        source.read([0])


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "empty"),
        (b"time [s],p_mc [bar]\n0,0\n", "not Parquet"),
        (parquet([TIME, PRESSURE], [[0.0] * 999, [5] * 999])[:-20], "cut off"),
        (parquet([TIME], [[]]), "no samples"),
    ],
)
def test_what_is_no_log(data, words):
    with pytest.raises(LogError, match=words):
        open_parquet(data, "run.parquet")


def test_flipped_bits_are_seen():
    sample = Path(__file__).parents[2] / "sample_logs/third_party/cal_ramp.parquet"
    data = bytearray(sample.read_bytes())
    for place in range(1000, len(data) // 2, len(data) // 20):
        damaged = bytearray(data)
        damaged[place] ^= 0x10
        with pytest.raises(LogError, match="damaged"):
            open_parquet(bytes(damaged), "run.parquet").read(range(20))


@pytest.mark.smoke
def test_units_that_pandas_was_given(tmp_path):
    frame = pd.DataFrame({"time": [0.0, 0.1], "p_mc": [1.0, 2.0]})
    frame.attrs["units"] = {"time": "s", "p_mc": "MPa"}
    frame.to_parquet(tmp_path / "run.parquet")
    columns = open_parquet((tmp_path / "run.parquet").read_bytes(), "run.parquet").columns
    assert columns == (Column("time", "s"), Column("p_mc", "MPa"))


def test_units_as_pandas_2_writes_them(tmp_path):
    table = pa.table({"time": [0.0, 0.1], "p_mc": [1.0, 2.0]})
    attrs = {b"PANDAS_ATTRS": b'{"units": {"time": "s", "p_mc": "MPa"}}', b"pandas": b"{}"}
    pq.write_table(table.replace_schema_metadata(attrs), tmp_path / "run.parquet")
    columns = open_parquet((tmp_path / "run.parquet").read_bytes(), "run.parquet").columns
    assert columns == (Column("time", "s"), Column("p_mc", "MPa"))


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_what_asammdf_exports(tmp_path):
    asammdf = pytest.importorskip("asammdf")
    time = np.arange(100) / 200
    signals = [
        asammdf.Signal(np.sin(time), time, unit="bar", name="p_mc"),
        asammdf.Signal(np.cos(time), time, unit="m/s", name="speed [km/h]"),
    ]
    with asammdf.MDF() as mdf:
        mdf.append(signals)
        mdf.export("parquet", tmp_path / "run.parquet")
    source = open_parquet((tmp_path / "run.parquet").read_bytes(), "run.parquet")
    found = {c.name: c for c in source.columns}
    assert found["time"] == Column("time", "s", "timestamps")
    assert found["p_mc"].unit is None  # asammdf drops it
    assert found["speed"].unit == "km/h"  # in the name it stays
    index = [c.name for c in source.columns].index("time")
    np.testing.assert_allclose(source.read([index])[0], time)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.99])
def test_every_cut_is_refused(share):
    data = parquet([TIME, PRESSURE], [list(np.arange(999) / 200), list(range(999))])
    with pytest.raises(LogError, match="cut off"):
        open_parquet(data[: int(share * len(data))], "run.parquet")
