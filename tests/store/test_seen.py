"""What a user has seen of stores: an older copy of a whole store, and the file of what was seen."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from calib.base.errors import SignatureRefused
from calib.store.store import Store
from calib.store.trust import require_signed, sign, verify_signed
from tests.support.signing import (
    ADA,
    EVE,
    REJECT,
    RELEASE,
    WITHDRAW,
    forget,
    passes,
    refusal,
    replaced_by,
    set_back,
    used,
)
from tests.support.tables import made_table

LESS = "an older copy of the store"

pytestmark = pytest.mark.usefixtures("seen")


@pytest.fixture
def store(signed_store):
    return signed_store


def test_a_withdrawal_that_nobody_signed_is_kept_by_what_was_seen_and_by_nothing_else(store, seen):
    before = len(store.journal().entries)
    store.judge("sedan@2", WITHDRAW)
    store.sign("sedan@1", ADA)  # a signature over the newer journal, of another version
    signature = store.folder / "sedan" / "v0001.minisig"
    used(store, "sedan@1")
    set_back(store, before)
    assert LESS in refusal(store)
    forget(seen)
    assert "the journal was set back" in refusal(store)
    signature.unlink()
    used(store)  # nothing in this store tells of the withdrawal any more


def test_an_older_store_than_the_one_seen_is_refused(store, copy, seen, tmp_path):
    old = copy("old")
    store.judge("sedan@2", WITHDRAW)
    used(store, "sedan@1")
    new = copy("new")
    was = seen.read_bytes()

    replaced_by(store, old)  # a freeze: journal, head, versions, signatures
    assert f"{store.folder}: {LESS}: its journal has 5 lines, 6 were seen" in refusal(store)
    assert f"remove the entry of its head from {seen}" in refusal(store)
    with pytest.raises(SignatureRefused, match=LESS):
        sign(store, "wagon@1", ADA)
    assert LESS in refusal(old)  # wherever it lies
    store.judge("sedan@2", REJECT)  # and where it went another way
    assert "its journal went another way: line 6 is not the one that was seen" in refusal(store)
    assert seen.read_bytes() == was

    shutil.rmtree(store.folder)
    store.save(made_table(27.0), replace(RELEASE, by="Eve"))
    store.sign("sedan@1", ADA)
    assert "another store was seen here before" in refusal(store, "sedan@1")

    replaced_by(store, new)
    used(store, "sedan@1")
    forget(seen)
    replaced_by(store, old)
    used(store)  # who has not seen the newer one cannot tell


def test_what_is_seen_is_the_newest_line_for_each_key_and_store(store, copy, seen):
    assert not seen.exists()
    used(store)
    (sight,) = json.loads(seen.read_text())["seen"]
    entries = store.journal().entries
    assert sight == {
        "key": ADA.key_id,
        "store": entries[0].hash,
        "place": str(store.folder.resolve()),
        "head": entries[-1].hash,
        "lines": 5,
    }
    sign(store, "sedan@2", EVE)
    verify_signed(store, ADA.public)
    found = json.loads(seen.read_text())["seen"]
    assert {(one["key"], one["lines"]) for one in found} == {(ADA.key_id, 6), (EVE.key_id, 6)}
    longer = store.journal().entries
    sign(store, "sedan@2", EVE)
    set_back(store, len(longer))
    used(store)  # what was seen with another key is no alarm
    moved = Store(store.folder.rename(store.folder.parent / "moved"))
    set_back(moved, 5)
    assert LESS in refusal(moved)


def test_what_was_refused_is_not_seen(store, seen):
    store.judge("wagon@1", RELEASE)
    assert not passes(store)
    refusal(store, "wagon@1")
    assert not seen.exists()


def test_a_line_that_comes_while_a_version_is_checked_is_no_alarm(store, monkeypatch):
    """Another process verifies a longer journal between our look at it and our note of it."""
    ours = Store.now

    def slower(self):
        found = ours(self)
        with monkeypatch.context() as patch:
            patch.setattr(Store, "now", ours)
            self.save(made_table(30.0))
            used(self)
        return found

    monkeypatch.setattr(Store, "now", slower)
    loaded = store.load("sedan@1")
    assert require_signed(loaded, ADA.public).note == ""
    monkeypatch.setattr(Store, "now", ours)
    set_back(store, 5)
    assert LESS in refusal(store)


def test_where_nothing_can_be_kept_there_is_a_note(store, seen, monkeypatch):
    seen.parent.parent.write_text("a file in the place of the folder")
    assert "an older copy of the store will not be noticed" in used(store).note
    assert used(store).note.startswith(str(seen))
    monkeypatch.setenv("XDG_STATE_HOME", "not/absolute")
    monkeypatch.setattr(Path, "home", lambda: seen.parents[2] / "home")
    assert used(store).note == ""
    assert (seen.parents[2] / "home" / ".local" / "state" / "brake-cal" / "seen.json").is_file()

    def no_home():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", no_home)
    assert used(store).note.startswith("this user has no home folder")


@pytest.mark.parametrize(
    "content", ["", "{}", '{"schema": 1, "seen": [{}]}', '{"schema": 2, "seen": []}', "\x00"]
)
def test_what_was_seen_is_not_passed_over_when_its_file_is_damaged(store, seen, content):
    used(store)
    seen.write_text(content)
    assert f"{seen}: is damaged" in refusal(store)
    assert seen.read_text() == content
