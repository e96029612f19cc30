"""`brake-cal station` as the line runs it."""

import json
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from calib.store.state import StateDecision
from calib.store.store import Store
from calib.table.table import Value
from tests.cli.conftest import parsed
from tests.support.command import files_under
from tests.support.documents import missing_and_unknown

SEDAN = Path(__file__).parents[2] / "sample_logs" / "sedan"
RAMP, COAST, DRY, ONTO_BASALT, WET = (
    SEDAN / f"{name}.csv"
    for name in ("ramp_wet_asphalt", "coast", "dry_asphalt_stop", "transition_dry_to_basalt",
                 "basalt_wet_pads")
)  # fmt: skip
VEHICLE = SEDAN / "vehicle.toml"


@pytest.fixture
def station(brake_cal, tmp_path):
    def run(*words, stops=(DRY, ONTO_BASALT), ramp=RAMP):
        options = ("--vehicle", VEHICLE, "--out", tmp_path / "car", "--store", tmp_path / "tables")
        return brake_cal("station", ramp, *stops, *options, *words)

    return run


GOOD = ("--coast", COAST, "--serial", "0815", "--rxswin", "R79", "--station", "EOL 3")
GOOD += ("--export", "dcm", "--export", "a2l", "--mass", "1744 kg", "--json")

_files_of_good_car = {}


@pytest.fixture
def good(station, tmp_path):
    """A good car that left the station; the first test to ask for it runs it."""
    if not _files_of_good_car:
        ran = station(*GOOD)
        assert ran.code == 0, ran.err
        _files_of_good_car.update(files_under(tmp_path), out=ran.out)
    for path, data in _files_of_good_car.items():
        if path != "out":
            (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / path).write_bytes(data)
    return json.loads(_files_of_good_car["out"])


def test_a_good_car_and_the_same_bytes_again(station, good, tmp_path):
    files = files_under(tmp_path)
    again = station(*GOOD)
    assert (again.code, parsed(again)) == (0, good)
    assert files_under(tmp_path) == files
    assert {p.name for p in (tmp_path / "car").iterdir()} == {
        "station.json", "junit.xml", "report.html", "summary.json", "table.dcm", "table.a2l",
        "dry_asphalt_stop.parquet", "transition_dry_to_basalt.parquet",
    }  # fmt: skip
    assert len(list((tmp_path / "tables" / "sedan-2up").iterdir())) == 1


def test_the_document_holds_together(good, tmp_path):
    assert good == json.loads((tmp_path / "car" / "station.json").read_text())
    assert good["identity"] == {"serial": "0815", "station": "EOL 3", "rxswin": "R79"}
    verdicts = [check["verdict"] for check in good["checks"]]
    assert {word: verdicts.count(word) for word in good["counts"]} == good["counts"]
    for check in good["checks"]:
        assert (check["action"] is None) == (check["verdict"] in ("passed", "not known"))
    assert [log["role"] for log in good["logs"]] == ["ramp", "coast", "hold-out", "hold-out"]
    assert good["validation"]["mass"]["stated"] is True
    record = json.loads((tmp_path / "tables/sedan-2up/v0001/record.json").read_text())
    assert record["record"]["provenance"]["identity"] == good["identity"]
    assert record["digest"] == good["table"]["digest"]


def test_a_car_that_fails_loses_its_exports(station, good, tmp_path):
    limits = tmp_path / "strict.toml"
    limits.write_text("schema = 1\n[limits]\npad_scale = { max = 0.9 }\n")
    assert station("--export", "dcm", "--limits", limits, stops=(DRY, WET)).code == 1
    assert not (tmp_path / "car" / "table.dcm").exists()
    document = json.loads((tmp_path / "car" / "station.json").read_text())
    failed = [check["figure"] for check in document["checks"] if check["verdict"] == "failed"]
    assert (document["verdict"], failed) == ("failed", ["pad_scale"])


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (("--export", "dmc"), 2),
        (("--vin", ""), 2),
        (("--accept-warnings", " "), 2),
        (("--limits", "none.toml"), 3),
        (("--coast", DRY), 3),
    ],
)
def test_refusals_leave_no_result(station, tmp_path, words, code):
    """The index is told of a car that cannot be judged, not of a mistake in what was typed."""
    assert station(*words).code == code
    refusals = ["car/refused.json"] if code == 3 and words[0] != "--limits" else []
    assert [str(path) for path in files_under(tmp_path)] == refusals


def test_a_refused_car_is_on_the_index_until_it_is_judged(station, good, brake_cal, tmp_path):
    """An earlier result stays as it was; the next verdict takes the refusal away."""
    files = files_under(tmp_path / "car")
    ran = station("--serial", "0815", "--station", "E 3", "--json", ramp=DRY)
    assert ran.code == 3
    files_after = files_under(tmp_path / "car")
    refusal = json.loads(files_after.pop(Path("refused.json")))
    assert files_after == files
    assert missing_and_unknown("refused-json", refusal) == []
    assert refusal["error"] == parsed(ran)["error"]
    assert refusal["identity"] == {"serial": "0815", "station": "E 3"}
    assert brake_cal("fleet", tmp_path).code == 0
    assert "0815: Refused" in (tmp_path / "index.html").read_text()
    assert station(*GOOD).code == 0
    assert files_under(tmp_path / "car") == files


def test_a_report_that_fails_leaves_no_version(station, tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "no space left")

    monkeypatch.setattr("calib.show.station_page.page_of", full)
    ran = station()
    assert (ran.code, ran.result) == (5, "")
    assert list(tmp_path.iterdir()) == []


def test_a_version_taken_in_between_is_not_claimed(station, tmp_path, monkeypatch):
    save = Store.save

    def late(store, table, decision):
        if not (store.folder / table.name).exists():
            other = replace(table.calibration, pad_scale=Value(0.9, 0.01))
            save(store, replace(table, calibration=other))
        return save(store, table, decision)

    monkeypatch.setattr(Store, "save", late)
    document = parsed(station("--json", stops=(DRY,)))
    assert document["table"]["id"] == document["validation"]["table"] == "sedan-2up@2"
    assert "sedan-2up@2" in (tmp_path / "car" / "report.html").read_text()
    assert {p.name for p in (tmp_path / "car").iterdir()} == {"station.json", *document["files"]}


def state_of(folder):
    return Store(folder / "tables").load("sedan-2up@1").state.word


def test_a_person_s_rejection_is_not_overruled_by_another_run(station, good, tmp_path):
    assert state_of(tmp_path) == "released"
    Store(tmp_path / "tables").judge("sedan-2up@1", StateDecision("rejected", "caliper cracked"))
    assert station(*GOOD).code == 0
    assert state_of(tmp_path) == "rejected"
    assert not (tmp_path / "car" / "table.dcm").exists()
    document = json.loads((tmp_path / "car" / "station.json").read_text())
    assert (document["verdict"], document["table"]["state"]) == ("passed", "rejected")


def test_warnings_pass_and_release_only_with_a_reason(station, tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text(
        "schema = 1\n[limits]\npad_scale = { fail = [0.5, 2.0], warn = [1.5, 1.9] }\n"
    )
    assert station("--limits", limits, "--export", "dcm", stops=(DRY,)).code == 0
    document = json.loads((tmp_path / "car" / "station.json").read_text())
    warned = [check["figure"] for check in document["checks"] if check["verdict"] == "warning"]
    assert (warned, state_of(tmp_path)) == (["pad_scale"], "draft")
    assert not (tmp_path / "car" / "table.dcm").exists()
    words = ("--limits", limits, "--export", "dcm", "--by", "Ada")
    assert station(*words, "--accept-warnings", "known", stops=(DRY,)).code == 0
    assert state_of(tmp_path) == "released"
    assert (tmp_path / "car" / "table.dcm").exists()


def test_no_car_is_measured_by_a_rejected_table_or_a_copy(station, good, tmp_path):
    store = Store(tmp_path / "tables")
    shutil.copytree(tmp_path / "tables/sedan-2up/v0001", tmp_path / "copy")
    assert station("--golden", tmp_path / "copy").code == 4
    store.judge("sedan-2up@1", StateDecision("rejected", "wet"))
    assert station("--golden", "sedan-2up@1").code == 4
    assert station("--golden", "sedan-2up").code == 4


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_stopped_it_is_no_verdict_and_leaves_nothing(tmp_path, number):
    words = [RAMP, DRY, "--vehicle", VEHICLE, "--out", tmp_path / "c", "--store", tmp_path / "t"]
    process = subprocess.Popen(
        [sys.executable, "-m", "cli.main", "station", *map(str, words)],
        cwd=Path(__file__).parents[2],
        stderr=subprocess.PIPE,
        text=True,
        # a test command in a shell's background ignores SIGINT, and so would this
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    first_line = process.stderr.readline()
    assert first_line.startswith("fitting")
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, list(tmp_path.iterdir())) == (130, [])
    assert err.removeprefix(first_line).count("\n") == 1  # within that line it may come once more
