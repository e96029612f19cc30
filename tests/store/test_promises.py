"""What the page `tables` promises of a store; of signatures, see `test_signatures`, `test_seen`."""

import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import calib.store.journal
import calib.store.store
import calib.store.version
from calib.base.errors import DamagedTable, StoreError
from calib.exports.export import ENDINGS, export
from calib.store.state import Evidence, StateDecision
from calib.store.store import Store
from calib.table.table import Value
from tests.support.command import files_under
from tests.support.killed import killed
from tests.support.tables import made_table

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "calib" / "manual" / "tables.md"

RELEASE = StateDecision("released", "four stops agree", by="Ada")
REJECT = StateDecision("rejected", "front pads wet", by="Ada")
WITHDRAW = StateDecision("withdrawn", "pads recalled", by="Ada")


def lines_of(store):
    return (store.folder / "journal.jsonl").read_bytes().splitlines(keepends=True)


def rewrite(store, lines):
    (store.folder / "journal.jsonl").write_bytes(b"".join(lines))


def test_every_promise_has_its_test():
    part = PAGE.read_text().partition("## What the store promises")[2]
    promises = re.findall(r"^\* \*\*(.*?)\.\*\*", part, flags=re.MULTILINE)
    assert len(promises) > 10
    names = {"test_" + re.sub(r"\W+", "_", promise.lower()).strip("_") for promise in promises}
    files = (Path(__file__).with_name(f"test_{x}.py") for x in ("promises", "signatures", "seen"))
    texts = "".join(file.read_text() for file in files)
    assert names <= {*re.findall(r"^def (test_\w+)", texts, flags=re.MULTILINE)}


def test_a_version_never_changes(three):
    files = files_under(three.folder / "sedan")
    for decision in (RELEASE, REJECT, WITHDRAW):
        three.judge("sedan@2", decision)
    assert files_under(three.folder / "sedan") == files
    assert three.load("sedan@2").state.word == "withdrawn"


def test_the_same_content_saved_again_is_the_same_version(three):
    table = made_table(28.0)
    again = three.save(table)
    assert (again.version, again.existed) == (2, True)
    D = table.difference
    rounded = replace(table, difference=replace(D, D=D.D * (1.0 + 1e-9)))
    assert rounded.digest != table.digest
    assert three.save(rounded).version == 2
    other = replace(table, difference=replace(D, lower=D.lower * (1.0 + 1e-4)))
    assert (three.save(other).version, three.save(other).existed) == (4, True)


def test_a_number_is_never_given_twice(three):
    shutil.rmtree(three.folder / "sedan" / "v0003")
    assert three.save(made_table(30.0)).version == 4
    (three.folder / "sedan" / "v0005").write_text("not a version")
    assert three.save(made_table(31.0)).version == 6
    shutil.rmtree(three.folder / "sedan")
    assert three.save(made_table(32.0)).version == 7


def test_a_bare_name_never_means_a_rejected_or_withdrawn_version(three):
    assert three.load("sedan").version == 3
    three.judge("sedan@3", REJECT)
    assert three.load("sedan").version == 2
    three.judge("sedan@2", WITHDRAW)
    assert three.load("sedan").version == 1
    assert three.load("sedan@3").state.word == "rejected"
    three.judge("sedan@1", REJECT)
    with pytest.raises(StoreError) as error:
        three.load("sedan")
    assert error.value.exit_code == 4


def test_only_a_released_version_is_handed_out(three, tmp_path):
    with pytest.raises(StoreError):
        three.released("sedan")
    three.judge("sedan@1", RELEASE)
    assert three.released("sedan").version == 1
    three.judge("sedan@3", REJECT)
    refused = three.load("sedan@3")
    for form, ending in ENDINGS.items():
        path = tmp_path / f"car.{ending}"
        with pytest.raises(StoreError):
            export(refused, path, form)
        assert not path.exists()
        export(refused, path, form, unreleased=True)
        text = path.read_bytes()
        assert b"NOT RELEASED" in text
        assert b"rejected" in text
        export(three.released("sedan"), path, form)
        assert b"NOT RELEASED" not in path.read_bytes()
    assert b"SEDAN_RELEASED (1U)" in (tmp_path / "car.h").read_bytes()


def test_a_rejected_version_is_released_only_on_new_evidence(three):
    proof = Evidence("summary.json", "ab" * 32)
    three.judge("sedan@1", replace(RELEASE, evidence=(proof,)))
    three.judge("sedan@1", REJECT)
    for old in (RELEASE, replace(RELEASE, evidence=(proof,))):
        with pytest.raises(StoreError):
            three.judge("sedan@1", old)
    new = Evidence("summary.json", "cd" * 32)
    station = replace(RELEASE, evidence=(new,), automatic=True)
    again = three.save(made_table(27.0), station)
    assert (again.version, again.state.word) == (1, "rejected")
    released = three.judge("sedan@1", replace(RELEASE, evidence=(new,)))
    assert released.state.evidence == (new,)


def test_a_withdrawn_version_stays_withdrawn(three):
    three.judge("sedan@1", WITHDRAW)
    for decision in (RELEASE, REJECT, replace(RELEASE, evidence=(Evidence("a", "b"),))):
        with pytest.raises(StoreError):
            three.judge("sedan@1", decision)
    assert three.save(made_table(27.0)).state.word == "withdrawn"


def recomputed(path):
    """A record with another pad friction, its digest and every hash in it computed anew."""
    stored = Store(path.parent.parent).load("sedan@2")
    pads = replace(stored.table.calibration, pad_friction_f=Value(0.5, 0.01))
    elsewhere = Store(path.parent.parent.parent / "forge")
    elsewhere.save(made_table(27.0))
    forged = elsewhere.save(replace(stored.table, calibration=pads))
    shutil.rmtree(path)
    shutil.copytree(forged.path, path)


def swapped(path):
    other = path.parent / "v0001"
    data = (other / "paper.parquet").read_bytes()
    (path / "paper.parquet").write_bytes(data)


def renumbered(path):
    shutil.move(path, path.parent / "v0007")


def replaced(path):
    shutil.rmtree(path)
    shutil.copytree(path.parent / "v0003", path)


@pytest.mark.parametrize("damage", [shutil.rmtree, recomputed, swapped, renumbered, replaced])
def test_a_version_that_is_missing_replaced_edited_or_renumbered_is_found_and_refused(
    three, damage
):
    damage(three.folder / "sedan" / "v0002")
    with pytest.raises(DamagedTable) as error:
        three.load("sedan@2")
    assert error.value.exit_code == 4
    assert not next(v for v in three.verify() if v.id == "sedan@2").sound
    assert three.load("sedan@1").version == 1


def test_a_missing_version_may_be_given_up(three):
    shutil.rmtree(three.folder / "sedan" / "v0003")
    assert not three.withdraw_missing("sedan@2", WITHDRAW)
    assert three.withdraw_missing("sedan@3", WITHDRAW)
    written = (three.folder / "journal.jsonl").read_bytes()
    assert three.withdraw_missing("sedan@3", WITHDRAW)  # the same again says nothing new
    assert (three.folder / "journal.jsonl").read_bytes() == written
    assert all(verdict.sound for verdict in three.verify())
    assert three.load("sedan").version == 2
    with pytest.raises(DamagedTable):
        three.load("sedan@3")
    assert three.save(made_table(30.0)).version == 4


def test_a_copy_outside_of_its_store_is_no_draft(three, tmp_path):
    three.judge("sedan@3", REJECT)
    shutil.copytree(three.folder / "sedan" / "v0003", tmp_path / "copy")
    state = three.load(str(tmp_path / "copy")).state
    assert not state.in_store
    assert "outside of its store" in state.description
    assert three.load(str(three.folder / "sedan" / "v0003")).state.word == "rejected"


def test_the_newest_version_that_is_missing_is_not_passed_over(three):
    shutil.rmtree(three.folder / "sedan" / "v0003")
    with pytest.raises(DamagedTable):
        three.load("sedan")


def test_a_version_that_the_journal_does_not_know_is_refused(three):
    shutil.copytree(three.folder / "sedan" / "v0003", three.folder / "sedan" / "v0004")
    with pytest.raises(DamagedTable):
        three.load("sedan@4")
    assert [v.id for v in three.verify() if not v.sound] == ["sedan@4"]
    assert three.load("sedan").version == 3
    lines = lines_of(three)
    rewrite(three, lines[:2])
    head = f"{json.loads(lines[1])['hash']} 2\n"
    (three.folder / "journal.head").write_text(head)
    shutil.rmtree(three.folder / "sedan" / "v0004")
    with pytest.raises(DamagedTable):
        three.load("sedan@3")
    assert [v.id for v in three.verify() if not v.sound] == ["sedan@3"]
    shutil.copytree(three.folder / "sedan", three.folder / "van")
    with pytest.raises(DamagedTable):
        three.load("van")


def forged(line, **changes):
    """A line with its own hash computed anew, as somebody who knows the format would."""
    import hashlib

    document = {**json.loads(line), **changes, "hash": ""}
    text = json.dumps(document, sort_keys=True, separators=(",", ":"))
    document["hash"] = hashlib.sha256(text.encode()).hexdigest()
    return json.dumps(document, sort_keys=True, separators=(",", ":")).encode() + b"\n"


TAMPER = {
    "a changed word": lambda x: [*x[:3], x[3].replace(b"rejected", b"released")],
    "a last line with a new hash": lambda x: [*x[:3], forged(x[3], state="released")],
    "a lost line": lambda x: [x[0], *x[2:]],
    "the last line lost": lambda x: x[:3],
    "a torn line": lambda x: [*x[:3], x[3][:-20]],
    "a key given twice": lambda x: [*x[:3], x[3].replace(b'{"at"', b'{"by":"Eve","at"')],
    "another spelling": lambda x: [*x[:3], x[3].replace(b":", b": ", 1)],
    "a state that there is not": lambda x: [*x, chained(x[3], state="golden")],
    "an event that there is not": lambda x: [*x, chained(x[3], event="loved")],
    "a version that was never stored": lambda x: [*x, chained(x[3], version=9)],
    "another table": lambda x: [*x, chained(x[3], digest="ab" * 32)],
    "nothing": lambda x: [],
    "no text": lambda x: [b"\xff\xfe\n"],
}


def chained(line, **changes):
    """A next line that follows by its number and hashes."""
    last = json.loads(line)
    return forged(line, number=last["number"] + 1, previous=last["hash"], **changes)


@pytest.mark.parametrize("kind", TAMPER)
def test_a_journal_that_was_changed_is_refused(three, kind):
    three.judge("sedan@3", REJECT)
    rewrite(three, TAMPER[kind](lines_of(three)))
    files = files_under(three.folder)
    for use in (
        lambda: three.load("sedan"),
        three.verify,
        lambda: [*three.entries()],
        lambda: three.save(made_table(30.0)),
        lambda: three.judge("sedan@1", RELEASE),
    ):
        with pytest.raises(DamagedTable) as error:
            use()
        assert error.value.exit_code == 4
        assert error.value.where == three.folder / "journal.jsonl"
    assert files_under(three.folder) == files


@pytest.mark.parametrize(
    "gone", [("journal.jsonl",), ("journal.head",), ("journal.jsonl", "journal.head")]
)
def test_a_journal_that_is_missing_is_refused(three, gone):
    for name in gone:
        (three.folder / name).unlink()
    with pytest.raises(DamagedTable):
        three.load("sedan")
    with pytest.raises(DamagedTable):
        three.save(made_table(30.0))


def test_a_stopped_writer_leaves_a_whole_version_or_none(store):
    """The writer is killed before each change of the disk."""
    reject = replace(REJECT, verdict="failed")
    for step in range(100):
        count = len([*store.entries()]) if store.folder.is_dir() else 0
        stopped = killed(lambda n=step: store.save(made_table(20.0 + n), reject), step)
        entries = [*store.entries()] if store.folder.is_dir() else ()
        assert len(entries) - count in ((0, 1) if stopped else (1,))
        assert all(entry.sound for entry in entries)
        assert all(entry.state.word == "rejected" for entry in entries)
        assert [e.version for e in entries] == list(range(1, len(entries) + 1))
        if not stopped:
            break
    assert step > 10
    assert all(verdict.sound for verdict in store.verify())
    store.save(made_table(99.0))
    assert not [*store.folder.glob("*/.new-*")]


@pytest.mark.parametrize(
    "function", ["version._curve_bytes", "version.sync", "journal.write_whole", "journal.sync"]
)
def test_a_full_disk_stores_nothing_and_a_moved_version_is_kept(three, monkeypatch, function):
    def full(*_):
        raise OSError(28, "No space left on device")

    files = files_under(three.folder)
    with monkeypatch.context() as patch:
        patch.setattr(f"calib.store.{function}", full)
        with pytest.raises(StoreError):
            three.save(made_table(30.0))
    is_stored = function == "journal.sync"  # the journal is whole by then
    assert len([*three.entries()]) == (4 if is_stored else 3)
    assert is_stored or files_under(three.folder) == files
    assert all(verdict.sound for verdict in three.verify())
    assert three.save(made_table(31.0)).version == (5 if is_stored else 4)


WRITER = """
import sys
from calib.store.store import Store
from tests.support.killed import killed
from tests.support.tables import made_table
store, numbers = Store(sys.argv[1]), sys.argv[2:]
print("ready", flush=True)
sys.stdin.readline()
for number in numbers:
    store.save(made_table(float(number)))
"""


def test_several_writers_wait_for_each_other(store):
    """Two writers begin at once; both store the table 30, which becomes one version."""
    tables_of_writers = [[30, *range(first, first + 4)] for first in (21, 31)]
    writers = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, str(store.folder), *map(str, numbers)],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for numbers in tables_of_writers
    ]
    for process in writers:
        assert process.stdout.readline() == "ready\n"
    for process in writers:
        process.stdin.write("go\n")
        process.stdin.flush()
    for process in writers:
        process.communicate(timeout=120)
        assert process.returncode == 0
    entries = [*store.entries()]
    expected = {made_table(float(x)).digest for numbers in tables_of_writers for x in numbers}
    assert [entry.version for entry in entries] == list(range(1, 10))
    assert {entry.stored.digest for entry in entries} == expected
    assert all(verdict.sound for verdict in store.verify())


def test_the_order_of_the_journal_counts_not_the_clock(three, monkeypatch):
    class Back(calib.store.journal.datetime):
        @classmethod
        def now(cls, tz=None):
            return cls(1999, 12, 31, tzinfo=tz)

    monkeypatch.setattr(calib.store.journal, "datetime", Back)
    three.judge("sedan@3", REJECT)
    state = three.load("sedan@3").state
    assert (state.word, state.since[:4]) == ("rejected", "1999")
    assert three.load("sedan").version == 2
    assert all(verdict.sound for verdict in three.verify())
