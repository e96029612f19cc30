"""The files of a version: bytes, foreign readers, and every kind of damage."""

import json

import pandas as pd
import pyarrow.parquet as pq
import pytest

from calib.base.digest import sha256
from calib.base.errors import DamagedTable
from calib.store.version import read_version
from tests.support.tables import made_table


@pytest.fixture
def path(store):
    return store.save(made_table()).path


def test_pandas_reads_it_plainly_and_the_unit_is_in_the_field(path):
    frame = pd.read_parquet(path / "difference.parquet")
    pd.testing.assert_frame_equal(frame, pd.DataFrame(vars(made_table().difference)))
    units = [field.metadata for field in pq.read_schema(path / "difference.parquet")]
    assert units == [{b"unit": b"1"}] * 7


def flip(path, offset):
    """Change one byte of a file."""
    data = bytearray(path.read_bytes())
    data[offset] ^= 0x01
    path.write_bytes(bytes(data))


def cut(path, end):
    path.write_bytes(path.read_bytes()[:end])


def of_record(change):
    """Change the record as an editor would, digest and all else left as it is."""

    def damage(version):
        path = version / "record.json"
        document = json.loads(path.read_text())
        change(document)
        path.write_text(json.dumps(document, indent=2, sort_keys=True) + "\n")

    return damage


def key_twice(version):
    path = version / "record.json"
    path.write_text(path.read_text().replace('"version": 1', '"version": 1, "version": 1'))


def column_twice(version):
    """Append the last column once more, and write the new digest of the file into the record."""
    path, record = version / "tyre.parquet", version / "record.json"
    digest, table = sha256(path.read_bytes()), pq.read_table(path)
    pq.write_table(table.append_column(table.field(-1), table.column(-1)), path)
    record.write_text(record.read_text().replace(digest, sha256(path.read_bytes())))


DAMAGE = {
    "a byte of a column": lambda v: flip(v / "paper.parquet", 40),
    "the end of a file": lambda v: cut(v / "tyre.parquet", -9),
    "a missing curve": lambda v: (v / "difference.parquet").unlink(),
    "a missing record": lambda v: (v / "record.json").unlink(),
    "a key given twice": key_twice,
    "a column given twice": column_twice,
    "another spelling": lambda v: (v / "record.json").write_bytes(
        (v / "record.json").read_bytes() + b"\n"
    ),
    "another kind of document": lambda v: (v / "record.json").write_text("[1, 2]"),
    "a changed figure": of_record(lambda d: d["record"]["quality"].update(rms=0.001)),
    "a changed digest": of_record(lambda d: d.update(digest="0" * 64)),
    "no finite number": of_record(lambda d: d["record"]["quality"].update(rms=float("nan"))),
    "a changed parent": of_record(lambda d: d["parents"].pop()),
    "a key too many": of_record(lambda d: d.update(approved=True)),
    "another number": of_record(lambda d: d.update(version=2, id="sedan@2")),
    "another schema": of_record(lambda d: d["record"].update(schema=2)),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damage_is_found(path, store, kind):
    DAMAGE[kind](path)
    with pytest.raises(DamagedTable):
        read_version(path, "sedan@1")  # without the journal
    with pytest.raises(DamagedTable) as error:
        store.load("sedan@1")
    assert error.value.exit_code == 4
    (verdict,) = store.verify()
    assert verdict.id == "sedan@1"
    assert not verdict.sound
    assert next(store.entries()).violations  # a listing goes on
    assert store.save(made_table()).version == 2  # and it is not in the way of the next
