"""Save, load and list versions, and read the evidence on a version."""

import errno
import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from calib.base.errors import ExchangeError, StoreError, TableNotFound
from calib.store.evidence import read_evidence
from calib.store.state import StateDecision
from calib.store.store import Store
from tests.support.command import files_under
from tests.support.tables import made_table

RELEASE = StateDecision("released", "good", "passed", by="Ada")


@pytest.fixture
def stored(store):
    return store.save(made_table())


# Saving


def test_a_preview_is_what_is_saved(store):
    first = store.preview(made_table(), RELEASE)
    assert not store.folder.exists()
    saved = store.save(made_table(), RELEASE)
    for preview in (first, store.preview(made_table(), RELEASE)):
        assert (preview.id, preview.digest, preview.path) == (saved.id, saved.digest, saved.path)
        assert preview.state.description.startswith("released: good (by Ada")
        assert json.dumps(preview.table.content()[0]) == json.dumps(saved.table.content()[0])
    again = store.preview(made_table(), replace(RELEASE, state="rejected"))
    assert (again.version, again.state.word) == (1, "rejected")
    assert again.state.stored_at == saved.state.stored_at
    assert store.preview(made_table(30.0), RELEASE).version == 2


def test_an_unsound_table_is_not_stored(store):
    table = made_table()
    wrong = replace(table, paper=replace(table.paper, f1=2.0 * table.paper.f1))
    with pytest.raises(StoreError):
        store.save(wrong)
    assert not store.folder.exists()


def test_a_read_only_store_is_refused_and_still_read(stored, store, monkeypatch):
    def refuse(*arguments, **options):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(os, "mkdir", refuse)
    files = files_under(store.folder)
    for name in ("sedan", "wagon"):
        with pytest.raises(StoreError):
            store.save(made_table(28.0, name))
    assert files_under(store.folder) == files
    assert store.save(made_table()).version == 1
    assert store.load("sedan").version == 1


# Loading


def test_a_reference_is_a_name_a_version_or_a_path(store):
    table = made_table()
    saved = store.save(table)
    assert (saved.id, saved.path) == ("sedan@1", store.folder / "sedan" / "v0001")
    store.save(made_table(28.0))
    assert store.load("sedan").version == 2
    assert store.load("sedan@1").digest == table.digest
    for path in (saved.path, saved.path / "record.json"):
        assert Store(Path("elsewhere")).load(str(path)).digest == table.digest


@pytest.mark.parametrize(
    "reference",
    [
        *("sedna", "zebra", "sedan@7", "sedan@0", "sedan@-1", "sedan@latest", "sedan@"),
        *("nowhere/sedan", "../sedan@1"),
    ],
)
def test_what_is_not_there_is_a_usage_error_with_the_nearest_name(stored, store, reference):
    uses = (store.load, lambda x: store.judge(x, RELEASE))
    for use in uses[: 1 if "/" in reference else 2]:
        with pytest.raises(TableNotFound) as error:
            use(reference)
        assert error.value.exit_code == 2
        assert ("'sedan'" in error.value.do) == (reference == "sedna")


def test_a_directory_or_a_file_that_is_no_version(stored, store, tmp_path):
    (tmp_path / "stop.csv").write_text("time [s]\n")
    for path in (store.folder / "sedan", tmp_path / "stop.csv", tmp_path / "none"):
        with pytest.raises(TableNotFound):
            store.load(str(path))
    with pytest.raises(TableNotFound):
        Store(tmp_path / "none").load("sedan")
    with pytest.raises(TableNotFound):
        store.verify("sedam")
    with pytest.raises(StoreError):
        store.load("..")


# Damage: see `test_version` and `test_promises`


def test_what_a_killed_writer_left_is_not_seen_and_cleared_by_the_next(stored, store):
    unfinished = store.folder / "sedan" / ".new-v0002"
    unfinished.mkdir()
    (unfinished / "paper.parquet").write_bytes(b"PAR1")
    assert [e.id for e in store.entries()] == ["sedan@1"]
    assert [(e.id, e.violations) for e in store.verify()] == [("sedan@1", ())]
    store.save(made_table(28.0))
    assert not unfinished.exists()
    assert [e.id for e in store.entries()] == ["sedan@1", "sedan@2"]


# Evidence


HOLD_OUT = {"log": "stop", "role": "hold-out", "verdict": "passed"}
VERSION = {"table": "sedan@1", "digest": made_table().digest, "proof": "truth"}
GOOD = {"schema": 1, **VERSION, "verdict": "passed", "logs": [HOLD_OUT]}


@pytest.mark.parametrize(
    ("document", "verdict"),
    [
        (GOOD, "passed"),
        ({**GOOD, "verdict": "failed"}, "failed"),
        ({**GOOD, "table": "sedan@2"}, None),
        ({**GOOD, "digest": "0" * 64}, None),
        ({**GOOD, "proof": "none"}, "consistent, not proved"),
        ({**GOOD, "verdict": "perhaps"}, None),
        ({**GOOD, "logs": [{**HOLD_OUT, "role": "calibration"}]}, None),
        ({**GOOD, "logs": [1]}, None),
        ({"schema": 1, "verdict": "warning", "table": {"id": "", "digest": ""}}, "warning"),
        ({"schema": 1, "verdict": "passed", "table": {"id": "", "digest": "0"}}, None),
        ([], None),
    ],
)
def test_evidence_is_of_one_version_only(stored, tmp_path, document, verdict):
    path = tmp_path / "summary.json"
    if isinstance(document, dict) and isinstance(document["table"], dict):
        table = document["table"]
        document = {**document, "table": {**table, "digest": table["digest"] or stored.digest}}
    path.write_text(json.dumps(document))
    if verdict:
        evidence, answer = read_evidence(path, stored)
        assert (evidence.name, answer) == ("summary.json", verdict)
    else:
        with pytest.raises(ExchangeError) as error:
            read_evidence(path, stored)
        assert error.value.exit_code == 3
