"""What a user has seen of stores: older copies of a store, and a damaged file."""

import shutil
from dataclasses import replace

import pytest

from calib.base.errors import SignatureRefused
from calib.store.signature import sign
from tests.support.signing import (
    ADA,
    REJECT,
    RELEASE,
    WITHDRAW,
    forget,
    passes,
    refusal,
    replaced_by,
    used,
)
from tests.support.tables import made_table


@pytest.fixture
def store(signed_store):
    return signed_store


def test_an_older_store_than_the_one_seen_is_refused(store, copy, seen_file):
    old = copy("old")
    store.judge("sedan@2", WITHDRAW)
    used(store, "sedan@1")
    new = copy("new")
    content = seen_file.read_bytes()

    replaced_by(store, old)  # a freeze: journal, head, versions, signatures
    assert str(seen_file) in refusal(store)
    with pytest.raises(SignatureRefused):
        sign(store, "wagon@1", ADA)
    refusal(old)  # wherever it lies
    store.judge("sedan@2", REJECT)  # and where it went another way
    refusal(store)
    assert seen_file.read_bytes() == content

    shutil.rmtree(store.folder)  # another store in the same place
    store.save(made_table(27.0), replace(RELEASE, by="Eve"))
    with pytest.raises(SignatureRefused):
        sign(store, "sedan@1", ADA)

    replaced_by(store, new)
    used(store, "sedan@1")
    forget(seen_file)
    replaced_by(store, old)
    used(store)  # who has not seen the newer one cannot tell


def test_what_was_refused_is_not_seen(store, seen_file):
    store.judge("wagon@1", RELEASE)
    assert not passes(store)
    refusal(store, "wagon@1")
    assert not seen_file.exists()


@pytest.mark.parametrize(
    "content",
    [
        *("", "{}", "[1]", "\x00", "[" * 100_000, '{"schema": 2, "seen": []}'),
        *('{"schema": 1, "seen": [{}]}', '{"schema": 1, "seen": 3}'),
    ],
)
def test_what_was_seen_is_not_passed_over_when_its_file_is_damaged(store, seen_file, content):
    used(store)
    seen_file.write_text(content)
    refusal(store)
    assert seen_file.read_text() == content
