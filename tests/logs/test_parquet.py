"""Parquet: units from the field metadata."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.base.errors import LogError
from calib.logs.parquet import open_parquet
from calib.logs.source import Column
from tests.support.refusals import refusal


def parquet(fields, columns, metadata=None):
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table(columns, schema=pa.schema(fields, metadata)), sink)
    return sink.getvalue().to_pybytes()


TIME = pa.field("time", pa.float64(), metadata={"unit": "s"})
PRESSURE = pa.field("p_mc", pa.int32(), metadata={"unit": "kPa"})


def test_unit_comes_from_the_metadata():
    source = open_parquet(parquet([TIME, PRESSURE], [[0.0, 0.1], [5, None]]), "run.parquet")
    assert source.columns == (Column("time", "s"), Column("p_mc", "kPa"))
    (pressure,) = source.read([1])
    assert pressure[0] == 5.0
    assert pressure[1] != pressure[1]  # a null is no value


WHOLE = parquet([TIME, PRESSURE], [list(np.arange(999) / 200), list(range(999))])


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "empty"),
        (b"time [s],p_mc [bar]\n0,0\n", "not Parquet"),
        (parquet([TIME], [[]]), "no samples"),
        (parquet([pa.field("time", pa.string())], [["open"]]), "string"),
        *((WHOLE[: int(share * len(WHOLE))], "cut off") for share in (0.1, 0.9, 0.99)),
        (WHOLE[:-20], "cut off"),
    ],
)
def test_what_is_no_log(data, says):
    assert says in refusal(lambda: open_parquet(data, "run.parquet").read([0]), kind=LogError)


def test_flipped_bits_are_seen():
    sample = Path(__file__).parents[2] / "sample_logs/third_party/cal_ramp.parquet"
    data = bytearray(sample.read_bytes())
    for place in range(1000, len(data) // 2, len(data) // 20):
        damaged = bytearray(data)
        damaged[place] ^= 0x10
        with pytest.raises(LogError, match="damaged"):
            open_parquet(bytes(damaged), "run.parquet").read(range(20))
