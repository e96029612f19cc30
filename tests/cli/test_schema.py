"""`brake-cal schema`: what it prints, in the judgement of another program's validator."""

import json
import tomllib
from pathlib import Path

import pytest
from cli.schema import SCHEMAS
from jsonschema import Draft202012Validator

from calib.help.documents import documents

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "sample_logs"
VEHICLES = sorted(SAMPLES.rglob("vehicle*.toml"))
MAPS = sorted((SAMPLES / "real").glob("*.toml"))
RECORDS = sorted((ROOT / "tables").rglob("record.json"))
KINDS = ("vehicle", "model", "limits", "channel-map", "settings", "table", "summary",
         "vehicle-facts")  # fmt: skip
MODEL = """
schema = 1
[pads]
front = 0.30
rear = "34 %"
[effects.aerodynamic_drag]
drag_area = "6600 cm²"
[[surfaces]]
start = "4500 ms"
stiffness = 0.8
peak = 0.5
[empirical]
place = "body"
driver = "speed"
knots = [5.0, 20]
values = [0.0, -0.05]
"""
SUMMARY = """{"schema": 1, "table": "sedan@1", "verdict": "passed", "eta": null,
"logs": [{"log": "stop", "role": "hold-out", "verdict": "passed", "figures": {}}]}"""


@pytest.fixture(scope="module")
def refusals():
    """Errors that an independent validator sees in a document, as key paths."""
    from typer.testing import CliRunner

    from cli.main import app

    validators = {}
    for kind in KINDS:
        schema = json.loads(CliRunner().invoke(app, ["schema", kind]).stdout)
        Draft202012Validator.check_schema(schema)
        validators[kind] = Draft202012Validator(schema)
    return lambda kind, document: [
        ".".join(map(str, error.path)) for error in validators[kind].iter_errors(document)
    ]


def test_without_a_name_it_lists_the_files(brake_cal):
    lines = brake_cal("schema").out.splitlines()
    assert [line.split()[0] for line in lines] == [*SCHEMAS, *documents()]
    listed = json.loads(brake_cal("schema", "--json").out)
    assert list(listed["files"]) == list(SCHEMAS)
    assert {*KINDS} <= {*SCHEMAS}
    assert list(listed["documents"]) == list(documents())


def test_the_schema_of_a_document_is_printed(brake_cal):
    printed = json.loads(brake_cal("schema", "fit-json").out)
    assert printed == documents()["fit-json"].schema
    assert "did you mean 'fit-json'?" in brake_cal("schema", "fit-jsn").err


def test_a_misspelt_name_is_a_usage_error_with_a_hint(brake_cal):
    ran = brake_cal("schema", "vehicel")
    assert ran.code == 2
    assert "did you mean 'vehicle'?" in ran.err
    assert "lists the known ones" in brake_cal("schema", "zzz").err


@pytest.mark.parametrize(
    ("kind", "path"),
    [
        *(("vehicle", path) for path in VEHICLES),
        *(("channel-map", path) for path in MAPS),
        ("limits", SAMPLES / "limits.toml"),
    ],
    ids=lambda x: x if isinstance(x, str) else str(x.relative_to(SAMPLES)),
)
def test_sample_files_are_accepted(refusals, kind, path):
    assert refusals(kind, tomllib.loads(path.read_text())) == []


@pytest.mark.parametrize("path", RECORDS, ids=lambda path: path.parent.parent.name)
def test_stored_records_are_accepted(refusals, path):
    assert refusals("table", json.loads(path.read_text())) == []


def test_what_the_program_writes_is_accepted(refusals, brake_cal):
    written = brake_cal("limits", "init").out
    assert refusals("limits", tomllib.loads(written)) == []


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ('"1744 kg"', '"1744 m"', "chassis.mass"),
        ('"1744 kg"', "1744", "chassis.mass"),
        ('"28.84 cm^2"', '"28.84 cm"', "front.piston_area"),
        ("pad_friction = 0.38", "pad_friction = 3.8", "front.pad_friction"),
        ("[rear]", "[raer]", ""),
        ("schema = 1", "schema = 2", "schema"),
        ('name = "sedan-2up"', "name = 5", "name"),
    ],
)
def test_broken_vehicles_are_refused(refusals, old, new, place):
    text = (SAMPLES / "sedan/vehicle.toml").read_text()
    assert old in text
    assert place in refusals("vehicle", tomllib.loads(text.replace(old, new, 1)))


def test_other_spellings_of_a_unit_are_accepted(refusals):
    text = (SAMPLES / "sedan/vehicle.toml").read_text()
    for old, new in (
        ('"28.84 cm^2"', '"2884 mm²"'),
        ('"1.20 kg*m^2"', '"1.20 kg·m**2"'),
        ('"1744 kg"', '"1.744t"'),
        ("pad_friction = 0.38", 'pad_friction = "38 %"'),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    assert refusals("vehicle", tomllib.loads(text)) == []


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("", "", None),
        ("drag_area", "drag_aera", "effects.aerodynamic_drag"),
        ("aerodynamic_drag", "aero_drag", "effects"),
        ("4500 ms", "4500 kg", "surfaces.0.start"),
        ("speed", "sped", "empirical"),
        ("0.30", "30", "pads.front"),
    ],
)
def test_models(refusals, old, new, place):
    refused = refusals("model", tomllib.loads(MODEL.replace(old, new, 1)))
    assert (refused == []) if place is None else (place in refused)


@pytest.mark.parametrize(
    ("kind", "text", "place"),
    [
        ("limits", "schema = 1\n[limits]\nvalid_shar = { min = 1 }", "limits"),
        ("limits", "schema = 1\n[limits]\nvalid_share = { fail = [1] }", "limits.valid_share.fail"),
        ("limits", "schema = 1\n[limits]\nvalid_share = 1", "limits.valid_share"),
        ("limits", "schema = 1", ""),
        ("channel-map", "schema = 1\n[channels.p_mx]\nsource = 'x'", "channels"),
        ("channel-map", "schema = 1\n[channels.p_mc]\nunit = 'bar'", "channels.p_mc"),
        ("channel-map", "schema = 1\ntext.decimal = ';'", "text.decimal"),
        ("channel-map", "schema = 1\ndbc = 5", "dbc"),
    ],
)
def test_broken_limits_and_maps_are_refused(refusals, kind, text, place):
    assert place in refusals(kind, tomllib.loads(text))


def test_documents_of_the_program(refusals):
    record = json.loads(RECORDS[0].read_text())
    record["record"]["vehicle"]["mass"] = "heavy"
    del record["digest"]
    assert set(refusals("table", record)) == {"", "record.vehicle.mass"}
    summary = json.loads(SUMMARY)
    assert refusals("summary", summary) == []
    assert refusals("summary", {**summary, "verdict": "perhaps"}) == ["verdict"]
