"""Parquet: units from the field metadata."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.errors import LogError
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


def test_no_unit_at_all():
    data = parquet([pa.field("p_mc", pa.float32())], [[1.0]])
    assert open_parquet(data, "run.parquet").columns == (Column("p_mc", None),)


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
