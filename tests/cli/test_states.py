"""`brake-cal tables release | reject | withdraw | log`, and what a state does to other commands."""

import hashlib
import json

import pytest

from calib.store.store import Store
from tests.support.tables import made_table


@pytest.fixture
def drafts(brake_cal, store):
    """Run a command of `brake-cal tables` on a store with the drafts sedan@1 and sedan@2."""
    for stiffness in (27.0, 28.0):
        Store(store).save(made_table(stiffness))
    return lambda *arguments: brake_cal("tables", *arguments, "--store", store)


@pytest.fixture
def summary(tmp_path, store):
    """Write the summary of a validation of sedan@1."""

    def write(verdict="passed", role="hold-out", **more):
        logs = [{"log": "stop", "role": role, "verdict": verdict}]
        digest = Store(store).load("sedan@1").digest
        document = {"schema": 1, "table": "sedan@1", "digest": digest, "verdict": verdict}
        path = tmp_path / "summary.json"
        path.write_text(json.dumps({**document, "logs": logs, **more}))
        return path

    return write


def test_a_release_holds_who_why_and_the_digest_of_the_evidence(drafts, summary, store):
    proof = summary()
    ran = drafts("release", "sedan@1", "--reason", "one stop", "--by", "Ada", "--evidence", proof)
    assert ran.code == 0
    assert ran.out.startswith("sedan@1 is released: one stop (by Ada, ")
    assert ran.out.endswith("; it was draft\n")
    state = Store(store).load("sedan@1").state
    assert (state.by, state.reason, state.verdict) == ("Ada", "one stop", "passed")
    (evidence,) = state.evidence
    assert evidence.name == "summary.json"
    assert evidence.sha256 == hashlib.sha256(proof.read_bytes()).hexdigest()
    again = drafts("release", "sedan@1", "--reason", "b", "--evidence", proof)
    assert "nothing to change" in again.out
    assert len(Store(store).journal().entries) == 3


@pytest.mark.parametrize(
    ("change", "code", "says"),
    [
        ({"verdict": "failed"}, 2, "says that sedan@1 failed, which releases nothing"),
        ({"role": "calibration"}, 3, "which proves nothing"),
        ({"digest": "0" * 64}, 3, "validation of sedan@1, digest 000000000000"),
        ({"table": "sedan@2"}, 3, "validation of sedan@2"),
        ({"logs": 3}, 3, "no summary of a validation"),
    ],
)
def test_evidence_that_does_not_speak_for_the_version(drafts, summary, store, change, code, says):
    proof = summary(**change)
    ran = drafts("release", "sedan@1", "--reason", "a", "--evidence", proof)
    assert (ran.code, ran.result) == (code, "")
    assert says in " ".join(ran.err.split())
    assert Store(store).load("sedan@1").state.word == "draft"


def test_the_document_of_a_station_is_evidence_for_its_table(drafts, store, tmp_path):
    path = tmp_path / "station.json"
    table = {"id": "elsewhere@7", "digest": Store(store).load("sedan@1").digest}
    path.write_text(json.dumps({"schema": 1, "verdict": "warning", "table": table, "more": 1}))
    assert drafts("release", "sedan@1", "--reason", "a", "--evidence", path).code == 0
    ran = drafts("release", "sedan@2", "--reason", "a", "--evidence", path)
    assert ran.code == 3
    assert "is of elsewhere@7" in ran.err


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (("release", "sedan", "--reason", "a"), 2, "'sedan' names no version; give sedan@N"),
        (("release", "sedan@9", "--reason", "a"), 2, "expected one of 1, 2"),
        (("release", "sedna@1", "--reason", "a"), 2, "did you mean 'sedan'"),
        (("release", "sedan@1"), 2, "--reason"),
        (("reject", "sedan@1", "--reason", " "), 2, "says nothing"),
        (("withdraw", "sedan@1", "--reason", "a", "--evidence", "x"), 2, "No such option"),
        (("log", "sedna"), 2, "did you mean 'sedan'"),
        (("log", "sedan@9"), 2, "there is 1, 2"),
        (("find", "0815"), 2, "no table of '0815'"),
        (("list", "--state", "relased"), 2, "did you mean 'released'"),
        (("list", "--since", "yesterday"), 2, "is not a date"),
    ],
)
def test_what_is_typed_wrong_changes_nothing(drafts, store, words, code, says):
    before = Store(store).journal().entries
    ran = drafts(*words)
    assert (ran.code, ran.result) == (code, "")
    assert says in " ".join(ran.err.split())
    assert Store(store).journal().entries == before


def test_the_log_of_a_table_is_its_history(drafts, document):
    drafts("reject", "sedan@1", "--reason", "front pads wet", "--by", "Ada")
    drafts("withdraw", "sedan@1", "--reason", "pads recalled", "--by", "Bob")
    lines = drafts("log", "sedan").out.splitlines()[1:]
    assert [line.split()[1:4] for line in lines[2:]] == [
        ["sedan@1", "rejected", "Ada"],
        ["sedan@1", "withdrawn", "Bob"],
    ]
    assert len(drafts("log", "sedan@2").out.splitlines()) == 2
    entries = document(drafts("log", "sedan", "--json"))["entries"]
    assert [entry["state"] for entry in entries] == ["draft", "draft", "rejected", "withdrawn"]
    assert entries[3]["previous"] == entries[2]["hash"]


def test_a_bare_name_says_which_version_and_its_state(drafts, brake_cal, store, tmp_path):
    drafts("reject", "sedan@2", "--reason", "wet")
    assert "sedan@1" in drafts("show", "sedan").out
    ran = brake_cal("plot", "sedan", "--store", store, "--out", tmp_path / "a.png")
    assert "sedan@1 is draft" in ran.err
    out = drafts("diff", "sedan", "sedan@2").out
    assert out.startswith("sedan@1 (draft) and sedan@2 (rejected) are equal within bands")


def test_only_what_is_released_is_exported(drafts, tmp_path):
    out = tmp_path / "car.dcm"
    export = ("export", "sedan", "--format", "dcm", "--out", out)
    ran = drafts(*export)
    assert (ran.code, ran.result) == (4, "")
    assert "there is sedan@1 draft, sedan@2 draft" in ran.err
    drafts("release", "sedan@1", "--reason", "good")
    assert drafts(*export).code == 0
    assert "sedan@1" in out.read_text()
    ran = drafts("export", "sedan@2", "--format", "dcm", "--out", tmp_path / "b.dcm")
    assert ran.code == 4
    assert "--unreleased" in ran.err
    unreleased = ("export", "sedan@2", "--format", "dcm", "--out", tmp_path / "b.dcm")
    assert drafts(*unreleased, "--unreleased").code == 0
    assert "NOT RELEASED" in (tmp_path / "b.dcm").read_text()


def test_the_list_tells_versions_apart(drafts, document):
    drafts("release", "sedan@1", "--reason", "good")
    rows = document(drafts("list", "--json"))["tables"]
    assert [(row["id"], row["state"]) for row in rows] == [
        ("sedan@1", "released"),
        ("sedan@2", "draft"),
    ]
    first = rows[0]
    assert first["decelerations"] == pytest.approx([0.0, 0.3])
    assert first["usable"] == pytest.approx([0.0, 0.285])  # the last row is extrapolated
    assert first["band_width"] == pytest.approx(2.0 / 27.0)  # D = 27 x, half width 2 x
    assert len(document(drafts("list", "--state", "draft", "--json"))["tables"]) == 1
    assert document(drafts("list", "--since", "2999-01-01", "--json"))["tables"] == []
    assert "holds no such table" in drafts("list", "--serial", "1").out


def test_show_answers_first_whether_it_may_be_used(drafts, document):
    lines = drafts("show", "sedan@1").out.splitlines()
    assert lines[0].startswith("to be used  no: draft")
    assert lines[1].startswith("usable      0.00 to 0.29 g")
    answer = document(drafts("show", "sedan@1", "--json"))["answer"]
    assert answer["decelerations"] == pytest.approx([0.0, 0.285])  # the last row is extrapolated
    drafts("release", "sedan@1", "--reason", "good")
    assert document(drafts("show", "sedan@1", "--json"))["answer"]["usable"] is True
    assert "tables export sedan" in drafts("show", "sedan@1").out
