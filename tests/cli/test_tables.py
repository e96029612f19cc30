"""`brake-cal tables`: what is looked at and decided; evidence, histories, damage, means."""

import hashlib
import json
from dataclasses import replace

import pytest

from calib.base.warning import PlausibilityWarning
from calib.store.store import Store
from tests.cli.conftest import parsed
from tests.support.cars_of_a_line import car_table
from tests.support.tables import C, made_table


def test_the_list_has_every_version_and_its_filters(tables, two):
    rows = parsed(tables("list", "--json"))["tables"]
    assert [row["id"] for row in rows] == ["sedan@1", "sedan@2", "wagon@1"]
    assert rows[1]["digest"] == Store(two).load("sedan").digest
    assert rows[0]["usable"] == pytest.approx([0.0, 0.285])  # the last row is extrapolated
    assert rows[0]["band_width"] == pytest.approx(2.0 / 27.0)  # D = 27 x, half width 2 x
    lines = tables("list").out.splitlines()
    assert [line.split()[0] for line in lines[1:]] == [row["id"] for row in rows]
    for words, count in (
        (("--state", "draft"), 2),
        (("--state", "Draft"), 2),
        (("--serial", "0"), 0),
    ):
        assert len(parsed(tables("list", *words, "--json"))["tables"]) == count


def test_a_store_that_is_empty_or_not_there(brake_cal, tmp_path):
    ran = brake_cal("tables", "list", "--store", tmp_path, "--json")
    assert parsed(ran) == {"schema": 1, "store": str(tmp_path), "tables": []}
    assert brake_cal("tables", "list", "--store", tmp_path / "none").code == 2


def test_show_holds_the_whole_table(tables, two):
    shown = parsed(tables("show", "sedan@1", "--json"))
    record, curves = made_table().content()
    assert (shown["id"], shown["digest"]) == ("sedan@1", made_table().digest)
    assert shown["record"] == record
    assert shown["curves"]["paper"]["f1"] == curves["paper"]["f1"].tolist()
    assert shown["peak"] == pytest.approx({"eta": 1.005, "D": C * 0.005})
    assert shown["answer"]["usable"] is True
    out = tables("show", "sedan@1", "-v").out
    for part in (shown["digest"], "ramp.csv (abababababab)"):
        assert part in out
    assert tables("show", "sedna").code == 2
    (two / "wagon" / "v0001" / "tyre.parquet").unlink()
    assert tables("show", "wagon").code == 4


def test_diff_gives_the_gap_of_the_curves(tables, two):
    document = parsed(tables("diff", "sedan@1", "sedan", "--json"))
    D = next(gap for gap in document["curves"] if gap["curve"] == "D")
    assert D["largest"] == pytest.approx((28.0 - C) * 0.005)
    assert (document["a"], document["b"], document["identical"]) == ("sedan@1", "sedan@2", False)
    assert "+0.00500" in tables("diff", "sedan@1", "sedan").out
    assert parsed(tables("diff", "sedan@1", "sedan@1", "--json"))["identical"] is True


def test_verify_ends_with_4_and_says_where(tables, two):
    assert parsed(tables("verify", "--json"))["sound"] is True
    path = two / "sedan" / "v0001" / "paper.parquet"
    path.write_bytes(path.read_bytes()[:-1])
    ran = tables("verify", "--json")
    assert ran.code == 4
    assert [v["sound"] for v in parsed(ran)["versions"]] == [False, True, True]
    assert "paper.parquet" in tables("verify").out
    assert tables("verify", "wagon").code == 0


@pytest.fixture
def summary(tmp_path, store):
    """Write the summary of a validation of sedan@1."""

    def write(verdict="passed", role="hold-out", **more):
        logs = [{"log": "stop", "role": role, "verdict": verdict}]
        digest = Store(store).load("sedan@1").digest
        document = {"schema": 1, "table": "sedan@1", "digest": digest, "verdict": verdict}
        document |= {"proof": "truth"}
        path = tmp_path / "summary.json"
        path.write_text(json.dumps({**document, "logs": logs, **more}))
        return path

    return write


@pytest.fixture
def drafts(on_store, store):
    """Run a command of `brake-cal tables` on a store with the drafts sedan@1 and sedan@2."""
    for stiffness in (27.0, 28.0):
        Store(store).save(made_table(stiffness))
    return on_store


def test_a_release_holds_who_why_and_the_digest_of_the_evidence(drafts, summary, store, tmp_path):
    out, proof = tmp_path / "car.dcm", summary()
    assert drafts("export", "sedan", "--out", out).code == 4
    release = ("release", "sedan@1", "--reason", "one stop", "--by", "Ada", "--evidence", proof)
    document = parsed(drafts(*release, "--json"))
    assert (document["before"], document["state"]) == ("draft", "released")
    state = Store(store).load("sedan@1").state
    assert (state.by, state.reason, state.verdict) == ("Ada", "one stop", "passed")
    assert state.evidence[0].sha256 == hashlib.sha256(proof.read_bytes()).hexdigest()
    assert drafts(*release).code == 0
    assert len(Store(store).snapshot().journal.entries) == 3  # nothing was to be changed
    assert drafts("export", "sedan", "--out", out).code == 0
    assert drafts("export", "sedan@2", "--out", tmp_path / "b.dcm").code == 4
    assert drafts("export", "sedan@2", "--out", tmp_path / "b.dcm", "--unreleased").code == 0


@pytest.mark.parametrize(
    "words",
    [
        ("release", "sedan", "--reason", "a"),
        ("release", "sedan@9", "--reason", "a"),
        ("release", "sedan@1"),
        ("reject", "sedan@1", "--reason", " "),
        ("withdraw", "sedan@1", "--reason", "a", "--evidence", "x"),
        ("log", "sedan@9"),
    ],
)
def test_what_is_typed_wrong_changes_nothing(drafts, store, words):
    entries = Store(store).snapshot().journal.entries
    ran = drafts(*words)
    assert (ran.code, ran.result) == (2, "")
    assert Store(store).snapshot().journal.entries == entries


def test_the_log_of_a_table_is_its_history(drafts):
    drafts("reject", "sedan@1", "--reason", "front pads wet", "--by", "Ada")
    drafts("withdraw", "sedan@1", "--reason", "pads recalled", "--by", "Bob")
    entries = parsed(drafts("log", "sedan", "--json"))["entries"]
    assert [entry["state"] for entry in entries] == ["draft", "draft", "rejected", "withdrawn"]
    assert [entry["by"] for entry in entries[2:]] == ["Ada", "Bob"]
    assert entries[3]["previous"] == entries[2]["hash"]
    assert len(drafts("log", "sedan@2").out.splitlines()) == 2


CARS = ("sedan@1", "sedan@2", "sedan@3")


@pytest.fixture
def line(on_store, store):
    """Run a command of `brake-cal tables` on a store with sedan@1, @2, @3 of three cars."""
    for number, stiffness in enumerate((26.0, 27.0, 28.0), start=1):
        Store(store).save(car_table(number, stiffness))
    return on_store


def test_a_mean_has_its_parents_and_every_look_works_with_it(line, tmp_path):
    document = parsed(line("merge", *CARS, "--name", "golden", "--json"))
    assert (document["id"], document["cars"], document["eta"]) == ("golden@1", 3, [1.0, 1.005])
    assert [p["id"] for p in document["parents"]] == list(CARS)
    D = document["figures"][0]
    assert D["value"] == pytest.approx(0.135)
    assert D["between"] == pytest.approx(1.0 / 27.0, rel=1e-6)
    # t of two degrees of freedom times 1/sqrt(3)
    assert D["half_width"] == pytest.approx(4.30265 / 3.0**0.5 / 27.0, rel=1e-4)
    again = line("merge", *reversed(CARS), "--name", "golden")
    assert "golden@1" in again.out
    assert "sedan@3" in line("show", "golden").out
    assert line("diff", "golden", "sedan@1").code == line("verify").code == 0
    out = tmp_path / "golden.dcm"
    assert line("export", "golden@1", "--unreleased", "--out", out).code == 0
    assert b"sedan@1, sedan@2, sedan@3" in out.read_bytes()
    assert line("compare", out).code == 0


@pytest.fixture
def exported(tables, stored, tmp_path):
    def write(form, *more):
        out = tmp_path / "a"
        assert tables("export", stored.name, "--format", form, "--out", out, *more).code == 0
        return out

    return write


@pytest.mark.parametrize("form", ["dcm", "cdfx"])
def test_a_file_is_compared_with_the_table_that_it_names(brake_cal, tables, exported, form):
    out = exported(form, "--points", "6")
    diff = parsed(tables("compare", out, "--json"))
    assert (diff["in_store"], diff["unchanged"], diff["differences"]) == (True, True, [])
    assert diff["scalars"]["sedan_mass"] == 1744.0
    assert len(diff["curves"]["sedan_f1"]["x"]) == 6
    elsewhere = brake_cal("tables", "compare", out, "--store", out.parent / "none", "--json")
    assert (elsewhere.code, parsed(elsewhere)["in_store"]) == (0, False)
    Store(out.parent / "other").save(made_table(28.0))
    assert brake_cal("tables", "compare", out, "--store", out.parent / "other").code == 4
    out.write_text(out.read_text().replace("1744.0", "1745.0"))
    ran = tables("compare", out, "--json")
    assert (ran.code, parsed(ran)["unchanged"]) == (4, False)
    out.write_bytes(out.read_bytes()[: out.stat().st_size // 2])
    assert tables("compare", out).code == 3


def test_a_table_of_wheel_pressures_that_are_not_p_mc_is_released_to_no_ecu(tables, store):
    table = made_table(28.0)
    apart = PlausibilityWarning("wheel_pressures", "ramp", 0.3, (None, 0.06), (), "")
    Store(store).save(replace(table, warnings=(apart,)))
    ran = tables("release", "sedan@2", "--reason", "good")
    assert ran.code == 4
    assert Store(store).load("sedan@2").state.word == "draft"
    out = store.parent / "x.dcm"
    ran = tables("export", "sedan@2", "--unreleased", "--format", "dcm", "--out", out)
    assert (ran.code, out.exists()) == (4, False)
