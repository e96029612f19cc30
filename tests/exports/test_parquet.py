import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.exports.build import build
from calib.exports.plain import write_parquet
from tests.exports.conftest import bits


def read(content):
    return pq.read_table(pa.BufferReader(content), use_threads=False)


@pytest.mark.parametrize("points", [None, 16])
def test_pyarrow_sees_the_table_to_the_last_bit(real, truth, points):
    data = build(real, points)
    columns = read(write_parquet(data)).to_pydict()
    for name in ("f1", "f2", "D", "g"):
        at = [i for i, label in enumerate(columns["label"]) if label == f"{data.prefix}_{name}"]
        x, y = ([columns[c][i] for i in at] for c in ("x", "value"))
        assert bits(x, y) == truth(real).at(set(x))[name]
    assert len(at) == (points or len(real.table.tyre.slip))


def test_facts_are_metadata_and_scalars_have_no_axis(stored):
    table = read(write_parquet(build(stored)))
    facts = {k.decode(): v.decode() for k, v in table.schema.metadata.items()}
    assert (facts["table"], facts["version"], facts["digest"]) == ("sedan@1", "1", stored.digest)
    assert "clamped" in facts["ends"]
    row = next(r for r in table.to_pylist() if r["label"] == "sedan_mass")
    assert (row["axis"], row["x"], row["value"], row["unit"]) == (None, None, 1744.0, "kg")
