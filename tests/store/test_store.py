import errno
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import calib.store.commit
from calib.base.errors import DamagedTable, StoreError, TableNotFound
from calib.store.store import Store, StoreVerdict
from tests.support.tables import made_table

ROOT = Path(__file__).parents[2]


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "tables")


@pytest.fixture
def stored(table, store):
    return store.save(table)


def files_under(directory):
    return {p.relative_to(directory): p.read_bytes() for p in directory.rglob("*") if p.is_file()}


def flip(path, offset):
    """Change one byte of a file."""
    data = bytearray(path.read_bytes())
    data[offset] ^= 0x01
    path.write_bytes(bytes(data))


def rewrite(path, change):
    """Change the document of a record as an editor would, digest and all else left as it is."""
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document, indent=2, sort_keys=True) + "\n")


# Saving


def test_what_is_foreseen_is_what_is_saved(table, store):
    before = store.foreseen(table)
    assert not store.folder.exists()
    saved = store.save(table)
    assert (before.id, before.digest, before.path) == (saved.id, saved.digest, saved.path)
    assert json.dumps(before.table.content()[0]) == json.dumps(saved.table.content()[0])
    assert store.foreseen(table).id == saved.id
    assert store.foreseen(made_table(30.0)).version == 2


def test_a_saved_table_comes_back(table, store):
    saved = store.save(table)
    assert (saved.id, saved.path) == ("sedan@1", store.folder / "sedan" / "v0001")
    assert saved.digest == saved.table.digest == table.digest
    np.testing.assert_array_equal(saved.table.paper.f2, table.paper.f2)


def test_the_record_is_for_reading(stored):
    text = (stored.path / "record.json").read_text()
    document = json.loads(text)
    assert text == json.dumps(document, indent=2, sort_keys=True) + "\n"
    assert document["id"] == "sedan@1"
    assert document["parents"][0] == {"name": "ramp.csv", "digest": "ab" * 32}
    assert document["record"]["vehicle"]["mass"] == 1744.0


def test_one_content_is_one_version(table, store):
    first = store.save(table)
    second = store.save(made_table(28.0))
    assert (first.version, second.version) == (1, 2)
    before = files_under(store.folder)
    assert store.save(made_table()).version == 1
    assert store.save(made_table(28.0)).version == 2
    assert files_under(store.folder) == before


def test_one_content_is_one_sequence_of_bytes(tmp_path):
    for name in "ab":
        Store(tmp_path / name).save(made_table())
        Store(tmp_path / name).save(made_table(28.0))
    versions = [files_under(tmp_path / name / "sedan") for name in "ab"]
    assert versions[0] == versions[1]
    assert len(versions[0]) == 8


def test_an_unsound_table_is_not_stored(table, store):
    wrong = replace(table, paper=replace(table.paper, f1=2.0 * table.paper.f1))
    with pytest.raises(StoreError, match=r"\(18\)"):
        store.save(wrong)
    assert not store.folder.exists()


@pytest.mark.parametrize(
    "name",
    ["..", "../evil", "a/b", "/tmp/x", ".hidden", "", "a..b", "a@1", "a b", "x" * 101, "a\n"],
)
def test_a_name_cannot_lead_out_of_the_store(name, tmp_path):
    before = files_under(tmp_path)
    with pytest.raises(StoreError, match="cannot name a table") as refusal:
        Store(tmp_path / "tables").save(made_table(name=name))
    assert refusal.value.exit_code == 4
    assert files_under(tmp_path) == before
    assert list(tmp_path.iterdir()) == []


def test_a_read_only_store_is_refused_and_still_read(stored, store, monkeypatch):
    for directory in (store.folder / "sedan", store.folder):
        directory.chmod(0o555)
    if os.access(
        store.folder, os.W_OK
    ):  # root writes anywhere: let the system refuse as it would a user

        def refuse(*arguments, **options):
            raise OSError(errno.EROFS, os.strerror(errno.EROFS))

        monkeypatch.setattr(os, "mkdir", refuse)
    before = files_under(store.folder)
    with pytest.raises(StoreError, match="cannot be written"):
        store.save(made_table(28.0))
    with pytest.raises(StoreError, match="cannot be written"):
        store.save(made_table(name="wagon"))
    assert files_under(store.folder) == before
    assert store.save(made_table()).version == 1
    assert store.load("sedan").version == 1
    for directory in (store.folder, store.folder / "sedan"):
        directory.chmod(0o755)


def test_a_store_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "tables").write_text("")
    with pytest.raises(StoreError, match="cannot be written"):
        Store(tmp_path / "tables").save(made_table())


@pytest.mark.parametrize(
    ("failure", "seen"),
    [(OSError(errno.ENOSPC, "No space left"), StoreError), (KeyboardInterrupt(),) * 2],
)
def test_a_failed_save_leaves_nothing(store, monkeypatch, failure, seen):
    def fail(*arguments):
        raise failure

    with monkeypatch.context() as patch:
        patch.setattr(calib.store.commit, "write_record", fail)
        with pytest.raises(seen if isinstance(seen, type) else type(seen)):
            store.save(made_table())
    assert list(store.folder.rglob("*")) == []

    store.save(made_table())
    before = sorted(store.folder.rglob("*"))
    monkeypatch.setattr(calib.store.commit, "write_record", fail)
    with pytest.raises(seen if isinstance(seen, type) else type(seen)):
        store.save(made_table(28.0))
    assert sorted(store.folder.rglob("*")) == before


WRITER = """
import sys, time
from pathlib import Path
from calib.store.store import Store
from tests.support.tables import made_table
tables = [made_table(float(x)) for x in sys.argv[3:]]
store, go = Store(sys.argv[1]), Path(sys.argv[2])
Store(f"{store.folder}-warm-{sys.argv[3]}").save(made_table())
print("ready", flush=True)
while not go.exists():
    time.sleep(0.001)
for table in tables:
    store.save(table)
"""


def test_two_processes_do_not_clobber_each_other(tmp_path, store):
    go = tmp_path / "go"
    # Both bring 30, which must be stored once; the others are their own.
    writers = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, str(store.folder), str(go), *map(str, stiffnesses)],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            text=True,
        )
        for stiffnesses in ([21, 22, 30, 23, 24], [31, 32, 30, 33, 34])
    ]
    for writer in writers:
        assert writer.stdout.readline() == "ready\n"
    go.touch()
    for writer in writers:
        writer.communicate(timeout=60)
        assert writer.returncode == 0
    entries = store.list()
    expected = {made_table(float(x)).digest for x in (21, 22, 23, 24, 30, 31, 32, 33, 34)}
    assert [e.version for e in entries] == list(range(1, 10))
    assert {e.stored.digest for e in entries} == expected
    assert all(v.sound for v in store.verify())


# Loading


def test_a_reference_is_a_name_a_version_or_a_path(table, store):
    store.save(table)
    store.save(made_table(28.0))
    path = store.folder / "sedan" / "v0001"
    assert store.load("sedan").version == 2
    assert store.load("sedan@1").digest == table.digest
    assert Store(Path("elsewhere")).load(str(path)).id == "sedan@1"
    assert Store(Path("elsewhere")).load(str(path / "record.json")).digest == table.digest


def test_a_version_that_was_copied_out_of_its_store_still_loads(stored, tmp_path):
    copy = tmp_path / "copy"
    copy.mkdir()
    for file in stored.path.iterdir():
        (copy / file.name).write_bytes(file.read_bytes())
    assert Store(tmp_path).load(str(copy)).digest == stored.digest


@pytest.mark.parametrize(
    ("reference", "says"),
    [
        ("sedna", "did you mean 'sedan'"),
        ("zebra", "expected one of sedan, wagon"),
        ("sedan@7", "no version '7' of 'sedan'.* expected one of 1$"),
        ("sedan@0", "no version '0'"),
        ("sedan@-1", "no version '-1'"),
        ("sedan@latest", "no version 'latest'"),
        ("sedan@", "no version ''"),
        ("nowhere/sedan", "nowhere/sedan: no such directory"),
        ("../sedan@1", "no such directory"),
    ],
)
def test_what_is_not_there_is_said_with_what_is(stored, store, reference, says):
    store.save(made_table(name="wagon"))
    with pytest.raises(TableNotFound, match=says) as error:
        store.load(reference)
    assert error.value.exit_code == 2


def test_a_directory_that_is_no_version_is_said_to_be_none(stored, store):
    with pytest.raises(TableNotFound, match="like v0001"):
        store.load(str(store.folder / "sedan"))


def test_a_reference_of_two_dots_is_no_name(stored, store):
    with pytest.raises(StoreError, match="cannot name a table"):
        store.load("..")


def test_without_a_store_the_next_step_is_said(tmp_path):
    with pytest.raises(TableNotFound, match="brake-cal fit"):
        Store(tmp_path / "tables").load("sedan")


# Damage


DAMAGE = {
    "a byte of a column": (
        lambda v: flip(v / "paper.parquet", 40),
        "paper.parquet: its bytes differ",
    ),
    "the end of a file": (
        lambda v: (v / "tyre.parquet").write_bytes((v / "tyre.parquet").read_bytes()[:-9]),
        "tyre.parquet: its bytes differ",
    ),
    "a missing curve": (
        lambda v: (v / "difference.parquet").unlink(),
        "difference.parquet: missing",
    ),
    "a missing record": (lambda v: (v / "record.json").unlink(), "record.json: missing"),
    "half a record": (
        lambda v: (v / "record.json").write_bytes((v / "record.json").read_bytes()[:300]),
        "record.json: not JSON",
    ),
    "another kind of document": (
        lambda v: (v / "record.json").write_text("[1, 2]"),
        "2] is not a table",
    ),
    "a changed figure": (
        lambda v: rewrite(v / "record.json", lambda d: d["record"]["quality"].update(rms=0.001)),
        "record.json: the record or its digest was changed",
    ),
    "a changed digest": (
        lambda v: rewrite(v / "record.json", lambda d: d.update(digest="0" * 64)),
        "record.json: the record or its digest was changed",
    ),
    "a figure that is not finite": (
        lambda v: rewrite(
            v / "record.json", lambda d: d["record"]["quality"].update(rms=float("nan"))
        ),
        "record.json: record.quality.rms: nan; expected a finite number",
    ),
    "a changed parent": (
        lambda v: rewrite(v / "record.json", lambda d: d["parents"].pop()),
        "record.json: parents not in agreement",
    ),
    "a key too many": (
        lambda v: rewrite(v / "record.json", lambda d: d.update(approved=True)),
        "record.json: unknown key 'approved'",
    ),
    "a missing part": (
        lambda v: rewrite(v / "record.json", lambda d: d.pop("files")),
        "record.json: key 'files' is missing",
    ),
    "a changed number": (
        lambda v: rewrite(v / "record.json", lambda d: d.update(version=2, id="sedan@2")),
        "record.json: holds sedan@2 in the place of sedan@1",
    ),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damage_is_found_and_placed(stored, store, kind):
    damage, says = DAMAGE[kind]
    damage(stored.path)
    with pytest.raises(DamagedTable, match=says) as error:
        store.load("sedan@1")
    assert error.value.exit_code == 4
    (verdict,) = store.verify()
    assert verdict.id == "sedan@1"
    assert says in verdict.violations[0]
    assert store.list()[0].id == "sedan@1"  # a listing goes on


def test_any_changed_byte_of_a_curve_is_found(stored, store):
    path = stored.path / "difference.parquet"
    sound = path.read_bytes()
    for offset in np.random.default_rng(3).integers(0, len(sound), 40):
        flip(path, int(offset))
        with pytest.raises(DamagedTable, match=r"difference\.parquet"):
            store.load("sedan")
        path.write_bytes(sound)
    assert store.load("sedan").digest == stored.digest


def test_a_hole_in_the_versions_is_found(store):
    for stiffness in (27.0, 28.0, 29.0):
        store.save(made_table(stiffness))
    (store.folder / "sedan" / "v0002").rename(store.folder / "taken")
    verdicts = store.verify()
    assert [(v.id, v.sound) for v in verdicts] == [
        ("sedan@1", True),
        ("sedan@2", False),
        ("sedan@3", True),
    ]
    assert "missing" in verdicts[1].violations[0]
    assert store.save(made_table(30.0)).version == 4


def test_versions_that_changed_places_are_found(store):
    for stiffness in (27.0, 28.0):
        store.save(made_table(stiffness))
    home = store.folder / "sedan"
    (home / "v0001").rename(home / "aside")
    (home / "v0002").rename(home / "v0001")
    (home / "aside").rename(home / "v0002")
    assert [v.sound for v in store.verify()] == [False, False]


def test_a_damaged_version_is_not_in_the_way_of_the_next(stored, store):
    (stored.path / "record.json").write_text("{")
    assert store.save(made_table()).version == 2
    assert [v.sound for v in store.verify("sedan")] == [False, True]


def test_a_leftover_of_a_killed_writer_is_not_seen_and_cleared_by_the_next(stored, store):
    left = store.folder / "sedan" / ".new-v0002"
    left.mkdir()
    (left / "paper.parquet").write_bytes(b"PAR1")
    assert [e.id for e in store.list()] == ["sedan@1"]
    assert store.verify() == (StoreVerdict("sedan@1", ()),)
    assert store.unfinished() == (left,)
    store.save(made_table(28.0))
    assert store.unfinished() == ()
    assert [e.id for e in store.list()] == ["sedan@1", "sedan@2"]


def test_listing_is_by_name_and_number(store):
    for name, stiffness in (("wagon", 27.0), ("sedan", 27.0), ("sedan", 28.0)):
        store.save(made_table(stiffness, name))
    entries = store.list()
    assert [e.id for e in entries] == ["sedan@1", "sedan@2", "wagon@1"]
    assert entries[1].stored.digest == store.load("sedan").digest


def test_verify_of_an_unknown_name_says_so(stored, store):
    with pytest.raises(TableNotFound, match="did you mean 'sedan'"):
        store.verify("sedam")
