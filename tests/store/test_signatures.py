"""Each promise of a signature on the page `tables` of the manual by a test of its name."""

import hashlib
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

import calib.store.commit
import calib.store.store
from calib.base.errors import DamagedTable, SignatureRefused, StoreError
from calib.store.minisign import Statement
from calib.store.minisign import sign as minisig
from calib.store.minisign_keys import secret_file
from calib.store.state import Evidence
from calib.store.store import Store
from calib.store.trust import require_signed, sign, verify_signed
from calib.table.table import Value
from tests.support.signing import (
    ADA,
    EVE,
    NAMESAKE,
    REJECT,
    RELEASE,
    WITHDRAW,
    forget,
    passes,
    refusal,
    replaced_by,
    rewritten,
    set_back,
    used,
)
from tests.support.tables import made_table

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.usefixtures("seen")


@pytest.fixture
def store(signed_store):
    return signed_store


@pytest.fixture
def keys(tmp_path):
    """Ada's keys as the files of minisign."""
    secret, public = tmp_path / "ada.key", tmp_path / "ada.pub"
    secret.write_bytes(secret_file(ADA.public.number, bytes(range(32))))
    public.write_bytes(ADA.public.file)
    return secret, public


def minisign(*arguments):
    if shutil.which("minisign") is None:
        pytest.skip("minisign is not installed: apt install minisign")
    line = ["minisign", *map(str, arguments)]
    return subprocess.run(line, capture_output=True, text=True, check=False)


# Made and checked by minisign


def test_a_signature_is_checked_by_minisign_and_made_by_minisign(store, keys):
    home, (secret, public) = store.folder / "sedan", keys
    record, beside = home / "v0002" / "record.json", home / "v0002.minisig"
    ran = minisign("-Vm", record, "-x", beside, "-p", public)
    assert ran.returncode == 0, ran.stderr
    signed_at = store.journal().entries[3].hash  # the line before that of the signature
    stored = store.load("sedan@2")
    said = (
        f"brake-cal table=sedan version=2 state=released digest={stored.digest} journal={signed_at}"
    )
    assert f"Trusted comment: {said}\n" in ran.stdout

    lines = len(store.journal().entries)
    line = Statement("sedan", 2, "released", stored.digest, store.journal().head).line
    beside.unlink()
    ran = minisign("-S", "-W", "-s", secret, "-m", record, "-x", beside, "-t", line)
    assert ran.returncode == 0, ran.stderr
    assert used(store).signed.statement.line == line
    assert verify_signed(store, ADA.public).signed == {"sedan@1": "released", "sedan@2": "released"}
    assert len(store.journal().entries) == lines

    ran = minisign("-S", "-W", "-s", secret, "-m", record, "-x", beside, "-t", "my best table")
    assert ran.returncode == 0, ran.stderr
    assert "its trusted comment is not that of a table" in refusal(store)


def test_a_signature_covers_the_journal_and_is_told_in_it(store):
    line = store.journal().entries[-1]
    assert (line.event, line.id, line.state) == ("signed", "sedan@2", "released")
    assert (line.key, line.by) == (ADA.key_id, "Ada")
    assert used(store).signed.statement.head == line.previous


# What is refused


def edited(store, _):
    """The record with one more line end; journal, head and all hashes computed anew."""
    path = store.folder / "sedan" / "v0002" / "record.json"
    path.write_bytes(path.read_bytes() + b"\n")
    rewritten(store, {"sedan@2": hashlib.sha256(path.read_bytes()).hexdigest()})
    assert store.load("sedan@2").state.released
    assert all(verdict.sound for verdict in store.verify())


def computed_anew(store, tmp_path):
    """Another pad friction in a store that is sound in itself, with Ada's signatures."""
    table = store.load("sedan@2").table
    pads = replace(table.calibration, pad_friction_f=Value(0.5, 0.01))
    forge = Store(tmp_path / "forge")
    forge.save(made_table(27.0), RELEASE)
    forge.save(replace(table, calibration=pads), RELEASE)
    for name in ("v0001.minisig", "v0002.minisig"):
        shutil.copy(store.folder / "sedan" / name, forge.folder / "sedan" / name)
    replaced_by(store, forge)
    assert all(verdict.sound for verdict in store.verify())


def swapped_curve(store, _):
    home = store.folder / "sedan"
    shutil.copy(home / "v0001" / "paper.parquet", home / "v0002" / "paper.parquet")


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (edited, "does not hold with key .*: the data is not what was signed"),
        (computed_anew, "v0002.minisig: is of sedan@2, digest"),
        (swapped_curve, "paper.parquet: its bytes differ from their digest"),
    ],
)
def test_a_signed_version_that_was_edited_is_refused(store, tmp_path, damage, says):
    damage(store, tmp_path)
    with pytest.raises(StoreError, match=says) as error:
        used(store)
    assert error.value.exit_code == 4
    refused = [v.id for v in verify_signed(store, ADA.public).verdicts if not v.sound]
    assert "sedan@2" in refused


def test_a_record_that_changes_after_it_was_loaded_is_refused(store):
    loaded = store.load("sedan@2")
    edited(store, None)
    with pytest.raises(DamagedTable, match="was replaced while it was read"):
        require_signed(loaded, ADA.public)


def test_a_signature_of_another_version_is_refused(store, copy, tmp_path):
    home = store.folder / "sedan"
    shutil.copy(home / "v0001.minisig", home / "v0002.minisig")
    assert "v0002.minisig: is of sedan@1" in refusal(store)
    used(store, "sedan@1")

    store.sign("wagon@1", ADA)  # a table of another car, renamed, with its signature beside it
    forge = Store(tmp_path / "forge")
    renamed = forge.save(made_table(), replace(RELEASE, by="Eve"))
    shutil.copy(store.folder / "wagon" / "v0001.minisig", renamed.path.parent / "v0001.minisig")
    assert "is of wagon@1" in refusal(forge, "sedan@1")

    shutil.rmtree(home / "v0002")
    shutil.copytree(store.folder / "wagon" / "v0001", home / "v0002")
    shutil.copy(store.folder / "wagon" / "v0001.minisig", home / "v0002.minisig")
    assert not {v.id: v.sound for v in verify_signed(store, ADA.public).verdicts}["sedan@2"]
    with pytest.raises(DamagedTable, match="holds wagon@1 in the place of sedan@2"):
        store.load("sedan@2")


def test_a_statement_that_minisign_signed_over_another_record_is_refused(store, keys):
    """The statement is that of sedan@2, the signed file is the record of sedan@1."""
    home = store.folder / "sedan"
    line = used(store).signed.statement.line
    beside = home / "v0002.minisig"
    record = home / "v0001" / "record.json"
    assert (
        minisign("-S", "-W", "-s", keys[0], "-m", record, "-x", beside, "-t", line).returncode == 0
    )
    assert "the data is not what was signed" in refusal(store)


@pytest.mark.parametrize(
    "other", [{"table": "wagon"}, {"version": 1}, {"digest": "ab" * 32}, {"state": "draft"}]
)
def test_a_statement_that_is_not_of_the_signed_record_is_refused(store, other):
    """The key signed the right record, with a statement that a person wrote by hand."""
    path = store.folder / "sedan" / "v0002.minisig"
    line = replace(used(store).signed.statement, **other).line
    record = (store.folder / "sedan" / "v0002" / "record.json").read_bytes()
    path.write_bytes(minisig(ADA, record, line))
    assert "signed as draft, it was released then" in refusal(store) or "is of " in refusal(store)


def test_a_version_without_a_signature_of_the_key_is_refused(store):
    store.judge("wagon@1", RELEASE)
    assert refusal(store, "wagon@1").startswith(
        f"wagon@1: has no signature of key {ADA.key_id}; sign it with"
    )
    store.sign("wagon@1", EVE)
    assert f"is signed by key {EVE.key_id}, not by key {ADA.key_id}" in refusal(store, "wagon@1")
    assert "does not hold with key" in refusal(store, "sedan@2", NAMESAKE)
    path = store.folder / "wagon" / "v0001.minisig"
    path.write_bytes(path.read_bytes()[:-9])
    assert "is cut off" in refusal(store, "wagon@1")


def test_verify_wants_a_signature_of_what_is_released_only(store):
    found = verify_signed(store, ADA.public)
    assert all(verdict.sound for verdict in found.verdicts)
    assert found.signed == {"sedan@1": "released", "sedan@2": "released"}
    store.judge("wagon@1", RELEASE)
    unsound = [v for v in verify_signed(store, ADA.public).verdicts if not v.sound]
    assert [v.id for v in unsound] == ["wagon@1"]
    assert all(v.sound for v in verify_signed(store, ADA.public, "sedan").verdicts)


def test_two_keys_have_a_file_each_and_a_second_signature_takes_the_place_of_the_first(store):
    home = store.folder / "sedan"
    store.sign("sedan@2", EVE)
    named = home / f"v0002.{EVE.key_id}.minisig"
    assert named.is_file()
    for key in (ADA, EVE):
        used(store, "sedan@2", key)
    first = (home / "v0002.minisig").read_bytes()
    store.sign("sedan@2", ADA)
    assert (home / "v0002.minisig").read_bytes() != first
    assert sorted(p.name for p in home.glob("v0002.*")) == sorted(["v0002.minisig", named.name])
    named.rename(home / "v0002.minisig")  # whatever the name of the file
    used(store, "sedan@2", EVE)


@pytest.mark.parametrize("decision", [REJECT, WITHDRAW])
def test_a_signature_holds_until_the_state_changes(store, decision):
    store.judge("sedan@2", decision)
    assert f"sedan@2: signed as released, {decision.state} since (by Bob" in refusal(store)
    sign(store, "sedan@2", ADA)
    assert used(store).signed.statement.state == decision.state
    assert passes(store)


def test_an_older_version_is_not_offered_as_the_newest(store):
    """Whoever can write the store can reject sedan@2, or take its signature away."""
    store.judge("sedan@2", REJECT)
    older = store.released("sedan")
    assert older.version == 1
    assert require_signed(older, ADA.public).signed.stored.version == 1  # asked for by its number
    signature = store.folder / "sedan" / "v0002.minisig"
    content = signature.read_bytes()
    for says in ("sedan@2: signed as released, rejected since", "sedan@2: has no signature of key"):
        with pytest.raises(SignatureRefused, match=says):
            require_signed(older, ADA.public, newest=True)
        assert not passes(store)
        signature.unlink(missing_ok=True)
    signature.write_bytes(content)
    store.sign("sedan@2", ADA)
    assert require_signed(older, ADA.public, newest=True).signed.stored.version == 1
    never = store.save(made_table(31.0), REJECT)  # one that the key has never signed
    shutil.rmtree(never.path)
    assert require_signed(older, ADA.public, newest=True).signed.stored.version == 1


def test_a_state_that_came_back_without_the_key_is_refused(store):
    """Whoever can write the store can release what was rejected, but cannot sign that."""
    store.judge("sedan@2", REJECT)
    store.judge("sedan@2", replace(RELEASE, evidence=(Evidence("summary.json", "ab" * 32),)))
    assert store.released("sedan").version == 2
    assert "signed as released, rejected and released since" in refusal(store)


def test_released_again_on_more_evidence_is_no_other_state(store):
    store.judge("sedan@2", replace(RELEASE, evidence=(Evidence("summary.json", "ab" * 32),)))
    used(store)


def test_a_state_that_the_version_did_not_have_when_it_was_signed_is_refused(store, keys):
    """A statement that a person wrote by hand."""
    stored = store.load("wagon@1")
    path, record = store.folder / "wagon" / "v0001.minisig", stored.path / "record.json"
    for head, was in ((store.journal().head, "draft"), (store.journal().entries[0].hash, "not st")):
        line = Statement("wagon", 1, "released", stored.digest, head).line
        ran = minisign("-S", "-W", "-s", keys[0], "-m", record, "-x", path, "-t", line)
        assert ran.returncode == 0
        assert f"signed as released, it was {was}" in refusal(store, "wagon@1")


# The journal set back


def test_a_journal_that_does_not_contain_what_was_signed_is_refused(store, copy, seen):
    before, old = len(store.journal().entries), copy("old")
    store.judge("sedan@2", WITHDRAW)
    sign(store, "sedan@2", ADA)
    new = copy("new")

    set_back(store, before)  # the newer signature is still there
    forget(seen)
    assert store.released("sedan").version == 2
    assert "the journal was set back, or is that of another store" in refusal(store)
    with pytest.raises(SignatureRefused, match="the journal was set back"):
        sign(store, "wagon@1", ADA)
    assert not (store.folder / "wagon" / "v0001.minisig").exists()
    assert len(store.journal().entries) == before
    assert "the journal was set back" in refusal(store, "sedan@1")  # of whatever version

    replaced_by(store, new)
    (store.folder / "journal.jsonl").write_bytes((old.folder / "journal.jsonl").read_bytes())
    with pytest.raises(DamagedTable, match=r"has 5 lines, its head names 7: lines are lost"):
        used(store)
    forget(seen)
    assert len(store.folder.parent.joinpath("old", "journal.jsonl").read_bytes().splitlines()) == 5


def test_a_journal_of_another_store_is_refused(store, tmp_path):
    """The same versions in a store of its own, whose journal has another first line."""
    other = Store(tmp_path / "other")
    for stiffness in (27.0, 28.0):
        other.save(made_table(stiffness), replace(RELEASE, by="Eve"))
    for name in ("v0001.minisig", "v0002.minisig"):
        shutil.copy(store.folder / "sedan" / name, other.folder / "sedan" / name)
    assert other.load("sedan@2").record == store.load("sedan@2").record
    assert "is that of another store" in refusal(other)


# Writing


def test_a_stopped_signature_leaves_no_lie(store, monkeypatch):
    lines = len(store.journal().entries)
    path = store.folder / "sedan" / "v0002.minisig"
    before = path.read_bytes()
    store.judge("wagon@1", REJECT)

    def full(*_):
        raise OSError(28, "No space left on device")

    for version, was in (("sedan@2", before), ("wagon@1", None)):
        beside = store.folder / version.split("@")[0] / path.name.replace("2", version[-1])
        with monkeypatch.context() as patch:
            patch.setattr(calib.store.commit, "write_journal", full)
            with pytest.raises(StoreError, match="No space left"):
                store.sign(version, ADA)
        assert (beside.read_bytes() if beside.exists() else None) == was
    assert len(store.journal().entries) == lines + 1

    store.sign("sedan@2", ADA)
    set_back(store, lines + 1)  # as if it was stopped before the line
    assert path.read_bytes() != before
    used(store)
    store.sign("sedan@2", ADA)
    used(store)


SIGNER = """
import sys
from calib.store.store import Store
from tests.support.signing import ADA
store = Store(sys.argv[1])
print("ready", flush=True)
while True:
    store.sign("wagon@1", ADA)
"""


def test_a_signer_that_is_killed_leaves_a_store_that_holds(store):
    for run in range(8):
        line = [sys.executable, "-c", SIGNER, str(store.folder)]
        process = subprocess.Popen(line, cwd=ROOT, stdout=subprocess.PIPE)
        assert process.stdout.readline() == b"ready\n"
        time.sleep(0.01 + 0.017 * run)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        assert passes(store)
        if any(entry.event == "signed" for entry in store.journal().of("wagon")[1]):
            used(store, "wagon@1")
    assert store.sign("wagon@1", ADA).path.is_file()
    assert not list(store.folder.glob("*/.v*")) + list(store.folder.glob(".journal*"))


def test_a_store_that_is_older_than_its_journal_is_signed(tmp_path):
    shutil.copytree(ROOT / "tests" / "store" / "older" / "tables", tmp_path / "older")
    store = Store(tmp_path / "older")
    made = store.sign("sedan-2up@1", ADA)
    assert [e.event for e in store.journal().entries] == ["adopted"] * 2 + ["signed"]
    assert made.statement.head == store.journal().entries[1].hash
    assert used(store, "sedan-2up@1").signed.statement.state == "draft"


def test_a_store_gets_its_journal_before_its_first_signature(tmp_path, monkeypatch):
    """Else a signer that is stopped leaves a signature over a journal that nobody has."""
    shutil.copytree(ROOT / "tests" / "store" / "older" / "tables", tmp_path / "older")
    store = Store(tmp_path / "older")

    def stopped(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(calib.store.store, "commit_signature", stopped)
        with pytest.raises(KeyboardInterrupt):
            store.sign("sedan-2up@1", ADA)
    assert [e.event for e in Store(store.folder).journal().entries] == ["adopted"] * 2
    assert (store.folder / "journal.jsonl").is_file()


def test_what_a_stopped_signer_left_is_cleared_by_the_next_one(store):
    left = store.folder / "sedan" / ".v0002.minisig.x1y2z3"
    left.write_bytes(b"untrusted comm")
    used(store)
    store.sign("wagon@1", ADA)
    assert not left.exists()


def test_a_path_is_signed_in_its_own_store_and_nowhere_else(store, tmp_path):
    path = store.folder / "sedan" / "v0002"
    assert require_signed(Store("elsewhere").load(str(path)), ADA.public).note == ""
    shutil.copytree(path, tmp_path / "taken" / "v0002")
    with pytest.raises(SignatureRefused, match="is not in its place in a store"):
        require_signed(store.load(str(tmp_path / "taken" / "v0002")), ADA.public)


def test_a_key_shows_itself_by_its_number_only(store, seen, keys):
    sign(store, "wagon@1", ADA, "Ada")
    used(store, "wagon@1")
    words = [key.read_text().split("\n")[1] for key in keys]
    files = [p for p in (*store.folder.rglob("*"), seen) if p.is_file()]
    assert len(files) > 12
    for path in files:
        content = path.read_bytes().decode(errors="replace")
        assert bytes(range(32)).hex() not in content
        # the secret half of the secret key, the point of the public one
        assert not any(word[i : i + 16] in content for word in words for i in range(16, 40))
    assert any(ADA.key_id in path.read_text() for path in files if path.name == "journal.jsonl")
