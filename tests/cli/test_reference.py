"""`brake-cal effects`, `schema`, `manual`, `doctor`, `qualify`, `limits`, and the Tab key."""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from calib.car import forces
from calib.car.effects.catalogue import CATALOGUE
from calib.help import qualify
from calib.help.documents import FILES, documents
from calib.help.page import contents
from tests.cli.conftest import told
from tests.test_layers import HEAVY

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "sample_logs"


def test_every_effect_has_its_line_and_its_card(brake_cal):
    lines = brake_cal("effects").out.splitlines()
    assert [name for name in CATALOGUE if any(x.startswith(f"{name} ") for x in lines)] == [
        *CATALOGUE
    ]
    cards = told(brake_cal("effects", "--json"))["effects"]
    assert [card["name"] for card in cards] == list(CATALOGUE)
    (one,) = told(brake_cal("effects", "rear_proportioning", "--json"))["effects"]
    assert {p["name"]: p["unit"] for p in one["parameters"]} == {"knee_slope": "1", "knee": "Pa"}
    out = brake_cal("effects", "rear_proportioning").out
    assert one["equation"] in out
    assert all(p["name"] in out for p in one["parameters"])


@pytest.fixture(scope="module")
def refusals():
    """Errors that an independent validator sees in a document, as key paths."""
    from typer.testing import CliRunner

    from cli.main import app

    def validator(kind):
        schema = json.loads(CliRunner().invoke(app, ["schema", kind]).stdout)
        Draft202012Validator.check_schema(schema)
        return Draft202012Validator(schema)

    validators = {kind: validator(kind) for kind in FILES}
    return lambda kind, document: [
        ".".join(map(str, error.path)) for error in validators[kind].iter_errors(document)
    ]


def test_schemas_are_listed_and_those_of_documents_printed(brake_cal):
    listed = told(brake_cal("schema", "--json"))
    assert (list(listed["files"]), list(listed["documents"])) == ([*FILES], [*documents()])
    assert len(brake_cal("schema").out.splitlines()) == len(FILES) + len(documents())
    assert json.loads(brake_cal("schema", "fit-json").out) == documents()["fit-json"].schema


GOOD = [
    *(("vehicle", path) for path in sorted(SAMPLES.rglob("vehicle*.toml"))),
    *(("channel-map", path) for path in sorted((SAMPLES / "real").glob("*.toml"))),
    ("limits", SAMPLES / "limits.toml"),
    *(("table", path) for path in sorted((ROOT / "tables").rglob("record.json"))),
]


def test_sample_files_are_accepted(refusals, brake_cal):
    for kind, path in GOOD:
        read = tomllib.loads if path.suffix == ".toml" else json.loads
        assert refusals(kind, read(path.read_text())) == [], path
    assert refusals("limits", tomllib.loads(brake_cal("limits").out)) == []


CAR = (SAMPLES / "sedan/vehicle.toml").read_text()


def test_the_manual_is_listed_and_each_page_printed(brake_cal):
    assert [p["name"] for p in told(brake_cal("manual", "--json"))["pages"]] == [*contents()]
    assert told(brake_cal("manual", "ramp", "--json"))["text"].startswith("# ")
    assert brake_cal("manual", "xyzzy").code == 2


def test_limits_are_written_as_they_are_printed(brake_cal, tmp_path):
    path = tmp_path / "line.toml"
    assert brake_cal("limits", "--out", path).code == 0
    assert brake_cal("limits").out == path.read_text()
    rows = {row["limit"]["figure"]: row for row in told(brake_cal("limits", "--json"))["limits"]}
    assert rows["pad_scale"]["limit"]["high"] == 1.2


def test_doctor_finds_what_is_wrong(brake_cal, tmp_path, monkeypatch):
    assert told(ran := brake_cal("doctor", "--json"))["findings"]
    assert ran.code == brake_cal("doctor").code == 0
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("BRAKE_CAL_SETTINGS", raising=False)
    (tmp_path / "brake-cal.toml").write_text("[")
    ran = brake_cal("doctor", "--json")
    wrong = [x["name"] for x in told(ran)["findings"] if x["state"] == "wrong"]
    assert (ran.code, wrong) == (1, ["settings"])


def test_qualify_writes_what_holds_and_what_does_not(brake_cal, tmp_path, monkeypatch):
    """Closed forms only; `tests/help/test_qualify.py` makes all checks."""
    monkeypatch.setattr(qualify, "SUITE", dict(list(qualify.SUITE.items())[:2]))
    assert told(ran := brake_cal("qualify", "--out", tmp_path, "--json"))["verdict"] == "passed"
    assert ran.code == 0
    assert told(ran) == json.loads((tmp_path / "qualification.json").read_text())
    assert (tmp_path / "qualification.html").is_file()
    right = forces.brake_torque
    monkeypatch.setattr(forces, "brake_torque", lambda *given: 1.01 * right(*given))
    ran = brake_cal("qualify", "--out", tmp_path, "--json")
    assert ran.code == 1
    assert [c["name"] for c in told(ran)["checks"] if not c["held"]] == ["brake_torque"]


def completed(*words, store=""):
    code = "import sys\nfrom cli.main import main\ntry:\n    main()\nexcept SystemExit:\n"
    code += "    print(*sorted({m.split('.')[0] for m in sys.modules}))"
    line = ["brake-cal", *(str(store) if word == "STORE" else word for word in words)]
    environment = {
        **os.environ,
        "_BRAKE_CAL_COMPLETE": "complete_bash",
        "COMP_WORDS": "\n".join(line),
        "COMP_CWORD": str(len(words)),
    }
    ran = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT, env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    *offered, modules = ran.stdout.splitlines()
    assert not {*HEAVY, "rich"} & set(modules.split()) or words[0] != "tables"
    return offered


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (("tables", "show", "--store", "STORE", ""), ["sedan", "wagon"]),
        (("tables", "show", "--store", "STORE", "w"), ["wagon", "wagon@1"]),
        (("tables", "release", "--store", "STORE", ""), ["sedan@2", "sedan@1", "wagon@1"]),
        (("effects", ""), [*CATALOGUE]),
        (("manual", "r"), ["ramp", "reference"]),
    ],
)
def test_what_the_tab_key_offers(two, words, offered):
    assert completed(*words, store=two) == offered
