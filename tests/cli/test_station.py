"""`brake-cal station` as the line runs it."""

import gzip
import json
import os
import shutil
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

from calib.store.state import StateDecision
from calib.store.store import Store
from calib.table.table import Value
from tests.support.documents import missing_and_unknown

SEDAN = Path(__file__).parents[2] / "sample_logs" / "sedan"
RAMP, REPEAT, COAST, DRY, ONTO_BASALT, WET, VEHICLE = (
    SEDAN / name
    for name in (
        "ramp_wet_asphalt.csv",
        "ramp_wet_asphalt_repeat.csv",
        "coast.csv",
        "dry_asphalt_stop.csv",
        "transition_dry_to_basalt.csv",
        "basalt_wet_pads.csv",
        "vehicle.toml",
    )
)


@pytest.fixture
def station(brake_cal, tmp_path):
    def run(*words, stops=(DRY, ONTO_BASALT), ramp=RAMP):
        told = ("--vehicle", VEHICLE, "--out", tmp_path / "car", "--store", tmp_path / "tables")
        return brake_cal("station", ramp, *stops, *told, *words)

    return run


def content(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_good_car_and_the_same_bytes_again(station, tmp_path):
    words = ("--coast", COAST, "--serial", "0815", "--vin", "WVW1", "--export", "dcm", "--json")
    first = station(*words)
    assert first.code == 0, first.err
    before = content(tmp_path)
    again = station(*words)
    assert (again.code, again.out) == (0, first.out)
    assert content(tmp_path) == before
    assert {p.name for p in (tmp_path / "car").iterdir()} == {
        "station.json", "junit.xml", "report.html", "summary.json", "table.dcm",
        "dry_asphalt_stop.parquet", "transition_dry_to_basalt.parquet",
    }  # fmt: skip
    assert len(list((tmp_path / "tables" / "sedan-2up").iterdir())) == 1


def test_the_document_holds_together(station, tmp_path):
    ran = station("--serial", "0815", "--rxswin", "R79", "--station", "EOL 3", "--json")
    document = json.loads(ran.out)
    assert document == json.loads((tmp_path / "car" / "station.json").read_text())
    assert document["schema"] == 1
    assert document["identity"] == {"serial": "0815", "station": "EOL 3", "rxswin": "R79"}
    verdicts = [check["verdict"] for check in document["checks"]]
    assert {word: verdicts.count(word) for word in document["counts"]} == document["counts"]
    for check in document["checks"]:
        assert set(check) == {
            "scope", "figure", "meaning", "value", "fail", "warn", "verdict", "action"
        }  # fmt: skip
        assert (check["action"] is None) == (check["verdict"] in ("passed", "not known"))
    assert [log["role"] for log in document["logs"]] == ["ramp", "hold-out", "hold-out"]
    record = json.loads((tmp_path / "tables/sedan-2up/v0001/record.json").read_text())
    assert record["record"]["provenance"]["identity"] == document["identity"]
    assert record["digest"] == document["table"]["digest"]
    suite = ElementTree.parse(tmp_path / "car" / "junit.xml").getroot()[0]
    assert int(suite.get("tests")) == len(document["checks"])


def test_an_a2l_of_the_station_has_no_addresses_and_that_is_told(station, tmp_path):
    ran = station("--export", "a2l")
    assert ran.code == 0
    assert "table.a2l: all addresses are 0" in ran.err
    assert "all addresses are 0" in (tmp_path / "car" / "table.a2l").read_text()


def test_a_car_that_fails_loses_its_exports(station, tmp_path):
    assert station("--export", "dcm").code == 0
    assert (tmp_path / "car" / "table.dcm").exists()
    ran = station("--export", "dcm", stops=(DRY, WET))
    assert ran.code == 1
    assert not (tmp_path / "car" / "table.dcm").exists()
    document = json.loads((tmp_path / "car" / "station.json").read_text())
    failed = [check["figure"] for check in document["checks"] if check["verdict"] == "failed"]
    assert (document["verdict"], "repeatability_f" in failed) == ("failed", True)


def test_warnings_pass(station, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text(
        "schema = 1\n[limits]\npad_scale = { fail = [0.5, 2.0], warn = [1.5, 1.9] }\n"
        "valid_share = { min = 0.5 }\n"
    )
    ran = station("--limits", limits)
    assert ran.code == 0
    document = json.loads((tmp_path / "car" / "station.json").read_text())
    warned = [check["figure"] for check in document["checks"] if check["verdict"] == "warning"]
    assert warned == ["pad_scale"]


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (("--export", "dmc"), 2, "did you mean 'dcm'"),
        (("--date", "31.3.2025"), 2, "31.3.2025"),
        (("--vin", ""), 2, "is empty"),
        (("--golden", "sedan-2up"), 2, "no table store here"),
        (("--golden", "sedan@1"), 2, "no table store here"),
        (("--limits", "none.toml"), 3, "no such file"),
        (("--coast", DRY), 3, "will not do for a fit"),
        (("--coast", RAMP), 3, "give each run once"),
        (
            ("--coast", SEDAN / "ramp_wet_asphalt_repeat.csv"),
            3,
            "given as a coast, and it is a ramp",
        ),
        (("--ramp", COAST), 3, "given as a ramp, and it is a coast"),
    ],
)
def test_refusals_leave_no_result(station, tmp_path, words, code, says):
    """The index is told of a car that cannot be judged, not of a mistake in what was typed."""
    ran = station(*words)
    assert ran.code == code, ran.err
    assert says in " ".join(ran.err.split())
    assert [str(path) for path in content(tmp_path)] == ["car/refused.json"] * (
        code == 3 and words[0] != "--limits"
    )


def test_a_refused_car_is_on_the_index_until_it_is_judged(station, brake_cal, tmp_path):
    """An earlier result stays as it was; the next verdict takes the refusal away."""
    assert station("--serial", "0815").code == 0
    before = content(tmp_path / "car")
    ran = station("--serial", "0815", "--station", "E 3", "--json", ramp=DRY)
    assert ran.code == 3
    after = content(tmp_path / "car")
    refusal = json.loads(after.pop(Path("refused.json")))
    assert after == before
    assert missing_and_unknown("refused-json", refusal) == []
    assert refusal["error"] == json.loads(ran.out)["error"]
    assert refusal["identity"] == {"serial": "0815", "station": "E 3"}
    assert brake_cal("fleet", tmp_path).code == 0
    page = (tmp_path / "index.html").read_text()
    assert "0815: Refused" in page
    assert "this run will not do for a fit" in page
    assert station("--serial", "0815").code == 0
    assert content(tmp_path / "car") == before


@pytest.mark.parametrize(
    ("ramp", "stops", "code"), [(DRY, (WET,), 3), (RAMP, (RAMP,), 3), (RAMP, (DRY, DRY), 2)]
)
def test_logs_in_the_wrong_place(station, tmp_path, ramp, stops, code):
    assert station(ramp=ramp, stops=stops).code == code
    assert [str(path) for path in content(tmp_path)] == ["car/refused.json"] * (code == 3)


@pytest.mark.parametrize(
    ("name", "called"),
    [(b"r\xfcck.csv", "r\\udcfcck"), (b"car.csv", "car"), (b"a\x01.csv", "a\\x01")],
)
def test_a_hold_out_may_have_any_name(station, tmp_path, name, called):
    stop = tmp_path / os.fsdecode(name)
    shutil.copy(DRY, stop)
    ran = station("--json", stops=(stop,))
    assert ran.code == 0, ran.err
    assert {check["scope"] for check in json.loads(ran.out)["checks"]} == {"car", called}
    written = {path.name for path in (tmp_path / "car").iterdir()}
    assert written == {"station.json", "junit.xml", "report.html", "summary.json",
                       f"{called}.parquet"}  # fmt: skip
    assert station(stops=(stop,)).code == 0


def test_no_input_is_overwritten(station, tmp_path):
    (tmp_path / "car").mkdir()
    for name in ("table.csv", "hold.parquet"):
        ramp = tmp_path / "car" / name
        shutil.copy(RAMP, ramp)
        stop = tmp_path / "hold.csv"
        shutil.copy(DRY, stop)
        ran = station("--export", "csv", ramp=ramp, stops=(stop,))
        assert (ran.code, ran.result) == (2, "")
        assert "would overwrite" in ran.err
        assert ramp.read_bytes() == RAMP.read_bytes()


def test_two_endings_of_one_name_are_one_name(station, tmp_path):
    plain, packed = tmp_path / "stop.csv", tmp_path / "stop.csv.gz"
    shutil.copy(DRY, plain)
    packed.write_bytes(gzip.compress(ONTO_BASALT.read_bytes()))
    ran = station(stops=(plain, packed))
    assert (ran.code, ran.result) == (2, "")
    assert "two logs are named stop," in ran.err


def test_a_report_that_fails_leaves_no_version(station, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "no space left")

    monkeypatch.setattr("calib.show.station_page.page_of", full)
    ran = station()
    assert (ran.code, ran.result) == (5, "")
    assert "no space left" in ran.err
    assert list(tmp_path.iterdir()) == []


def test_a_version_taken_in_between_is_not_claimed(station, tmp_path, monkeypatch):
    save = Store.save

    def late(store, table, decision=None):
        if not (store.folder / table.name).exists():
            other = replace(table.calibration, pad_scale=Value(0.9, 0.01))
            save(store, replace(table, calibration=other))
        return save(store, table, decision)

    monkeypatch.setattr(Store, "save", late)
    ran = station("--json")
    assert ran.code == 0, ran.err
    document = json.loads(ran.out)
    assert document["table"]["id"] == document["validation"]["table"] == "sedan-2up@2"
    assert "sedan-2up@2" in (tmp_path / "car" / "report.html").read_text()
    assert {p.name for p in (tmp_path / "car").iterdir()} == {"station.json", *document["files"]}
    assert len(document["files"]) == 5


def test_a_damaged_store_is_told(station, tmp_path):
    assert station().code == 0
    journal = tmp_path / "tables/journal.jsonl"
    journal.write_bytes(journal.read_bytes().replace(b"passed", b"failed"))
    ran = station()
    assert ran.code == 4
    assert "journal.jsonl: line 1: was changed" in ran.err


def test_a_stated_mass_counts_in_the_ramp_and_in_the_stops(station, tmp_path):
    ran = station("--mass", "1800 kg", "--json")
    assert ran.code in (0, 1), ran.err
    mass = {"value": 1800.0, "tolerance": 0.005, "stated": True, "share": 1800.0 / 1744.0}
    assert json.loads(ran.out)["validation"]["mass"] == mass
    record = json.loads((tmp_path / "tables/sedan-2up/v0001/record.json").read_text())["record"]
    assert record["vehicle"]["mass"] == 1744.0
    heavy = record["calibration"]["pad_scale"]["value"]
    assert station("--mass", "1744 kg").code == 0
    record = json.loads((tmp_path / "tables/sedan-2up/v0002/record.json").read_text())["record"]
    assert heavy / record["calibration"]["pad_scale"]["value"] == pytest.approx(
        1800 / 1744, abs=2e-3
    )


def state_of(folder):
    return Store(folder / "tables").load("sedan-2up@1").state.word


def test_a_person_s_rejection_is_not_overruled_by_another_run(station, tmp_path):
    assert station("--export", "dcm").code == 0
    assert state_of(tmp_path) == "released"
    Store(tmp_path / "tables").judge("sedan-2up@1", StateDecision("rejected", "caliper cracked"))
    limits = tmp_path / "wide.toml"
    limits.write_text("schema = 1\n[limits]\nvalid_share = { min = 0.4 }\n")
    ran = station("--export", "dcm", "--limits", limits)
    assert ran.code == 0
    assert state_of(tmp_path) == "rejected"
    assert not (tmp_path / "car" / "table.dcm").exists()
    document = json.loads((tmp_path / "car" / "station.json").read_text())
    assert (document["verdict"], document["table"]["state"]) == ("passed", "rejected")


def test_warnings_release_only_with_a_reason(station, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text(
        "schema = 1\n[limits]\npad_scale = { fail = [0.5, 2.0], warn = [1.5, 1.9] }\n"
    )
    assert station("--limits", limits, "--export", "dcm").code == 0
    assert state_of(tmp_path) == "draft"
    assert not (tmp_path / "car" / "table.dcm").exists()
    assert station("--limits", limits, "--accept-warnings", " ").code == 2
    ran = station(
        "--limits", limits, "--export", "dcm", "--accept-warnings", "known", "--by", "Ada"
    )
    assert ran.code == 0
    assert state_of(tmp_path) == "released"
    assert "known" in (tmp_path / "car" / "table.dcm").read_text()


def test_no_car_is_measured_by_a_rejected_table_or_a_copy(station, tmp_path):
    assert station().code == 0
    store = Store(tmp_path / "tables")
    shutil.copytree(tmp_path / "tables/sedan-2up/v0001", tmp_path / "copy")
    ran = station("--golden", tmp_path / "copy")
    assert ran.code == 4
    assert "outside of its store" in ran.err
    store.judge("sedan-2up@1", StateDecision("rejected", "wet"))
    assert station("--golden", "sedan-2up@1").code == 4
    ran = station("--golden", "sedan-2up")
    assert ran.code == 4
    assert "has no released version; there is sedan-2up@1 rejected" in ran.err
