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


def test_units_in_the_names():
    fields = [pa.field("time [s]", pa.float64()), pa.field("p_mc [MPa]", pa.float32())]
    data = parquet(fields, [[0.0, 0.1], [1.0, 2.0]])
    assert open_parquet(data, "run.parquet").columns == (Column("time", "s"), Column("p_mc", "MPa"))


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
