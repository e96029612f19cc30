"""What a user has seen of stores: an older copy of a whole store, and the file of what was seen."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from calib.base.errors import SignatureRefused
from calib.store.signature import require_signed, sign, verify_signed
from calib.store.store import Store
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


@pytest.fixture
def store(signed_store):
    return signed_store


def test_an_older_store_than_the_one_seen_is_refused(store, copy, seen):
    old = copy("old")
    store.judge("sedan@2", WITHDRAW)
    used(store, "sedan@1")
    new = copy("new")
    was = seen.read_bytes()

    replaced_by(store, old)  # a freeze: journal, head, versions, signatures
    assert str(seen) in refusal(store)
    with pytest.raises(SignatureRefused):
        sign(store, "wagon@1", ADA)
    refusal(old)  # wherever it lies
    store.judge("sedan@2", REJECT)  # and where it went another way
    refusal(store)
    assert seen.read_bytes() == was

    shutil.rmtree(store.folder)  # another store in the same place
    store.save(made_table(27.0), replace(RELEASE, by="Eve"))
    with pytest.raises(SignatureRefused):
        sign(store, "sedan@1", ADA)

    replaced_by(store, new)
    used(store, "sedan@1")
    forget(seen)
    replaced_by(store, old)
    used(store)  # who has not seen the newer one cannot tell


def test_what_is_seen_is_the_newest_line_for_each_key_and_store(store, seen):
    used(store)
    (sight,) = json.loads(seen.read_text())["seen"]
    entries = store.journal().entries
    assert sight == {
        "key": ADA.public.key_id,
        "store": entries[0].hash,
        "place": str(store.folder.resolve()),
        "head": entries[-1].hash,
        "lines": 5,
    }
    sign(store, "sedan@2", EVE)
    verify_signed(store, ADA.public)
    found = json.loads(seen.read_text())["seen"]
    assert {(one["key"], one["lines"]) for one in found} == {
        (ADA.public.key_id, 6),
        (EVE.public.key_id, 6),
    }
    sign(store, "sedan@2", EVE)
    set_back(store, 6)
    used(store)  # what was seen with another key is no alarm
    moved = Store(store.folder.rename(store.folder.parent / "moved"))
    set_back(moved, 5)
    refusal(moved)


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

    loaded = store.load("sedan@1")
    with monkeypatch.context() as patch:
        patch.setattr(Store, "now", slower)
        assert require_signed(loaded, ADA.public).note == ""
    set_back(store, 5)
    refusal(store)


def test_where_nothing_can_be_kept_there_is_a_note(store, seen, monkeypatch):
    shutil.rmtree(seen.parents[1])
    seen.parents[1].write_text("a file in the place of the folder")
    assert str(seen) in used(store).note
    monkeypatch.setenv("XDG_STATE_HOME", "not/absolute")
    monkeypatch.setattr(Path, "home", lambda: seen.parents[2] / "home")
    assert used(store).note == ""
    assert (seen.parents[2] / "home" / ".local" / "state" / "brake-cal" / "seen.json").is_file()

    def no_home():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", no_home)
    assert used(store).note != ""


@pytest.mark.parametrize(
    "content",
    [
        *("", "{}", "[1]", "\x00", "[" * 100_000, '{"schema": 2, "seen": []}'),
        *('{"schema": 1, "seen": [{}]}', '{"schema": 1, "seen": 3}'),
    ],
)
def test_what_was_seen_is_not_passed_over_when_its_file_is_damaged(store, seen, content):
    used(store)
    seen.write_text(content)
    refusal(store)
    assert seen.read_text() == content
