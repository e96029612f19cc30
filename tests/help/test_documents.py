"""Each document that a command prints has the keys of its schema, and says what each means."""

import json
import re

import pytest
from jsonschema import Draft202012Validator

from calib.help.documents import documents
from tests.support.documents import missing_and_unknown
from tests.support.manual import run, working_folder

STATION = (
    "station ramp.csv stop_1.csv stop_2.csv --coast coast.csv --vehicle car.toml "
    "--limits line.toml --golden car@1 --serial 0815 --out 0815"
)
COMMANDS = (
    ("check-json", "check ramp.csv"),
    ("fit-json", "fit ramp.csv --vehicle car.toml"),
    ("validate-json", "validate car@1 stop.csv"),
    ("plot-json", "plot car --out table.png"),
    ("simulate-json", "simulate stop.csv --vehicle car.toml --out sim.csv"),
    ("effects-json", "effects hydraulic_lag"),
    ("vehicle-facts", "vehicle show car.toml"),
    ("map-json", "map my_ramp.csv"),
    ("settings-json", "settings"),
    ("manual-json", "manual"),
    ("tables-json", "tables list"),
    ("show-json", "tables show car"),
    ("diff-json", "tables diff car@1 car@2"),
    ("state-json", "tables release car@1 --reason good --evidence results/summary.json"),
    ("log-json", "tables log car"),
    ("verify-json", "tables verify"),
    ("export-json", "tables export car --format dcm --out car.dcm"),
    ("import-json", "tables compare car.dcm"),
    ("limits-json", "limits --out line.toml"),
    ("station-json", STATION),
    ("batch-json", "batch validate stop.csv --table car --out checked --workers 1"),
    ("fleet-json", "fleet checked/results.parquet --out fleet"),
)
ELSEWHERE = {
    *("diagnose-json", "plan-json", "qualification-json", "refused-json", "repeatability-json"),
    "error",
}
"""Commands that take long, and those that end with an error: see the tests of `calib.diagnose`,
`calib.help`, `cli.plan`, `cli.station`, `cli.repeatability` and `cli.commands`."""


def test_every_document_is_looked_at():
    assert set(documents()) == ELSEWHERE | {name for name, _ in COMMANDS}


def test_the_documents_have_the_keys_of_their_schemas(tmp_path, capsys):
    working_folder(tmp_path)
    wrong: list[str] = []
    for name, line in COMMANDS:
        capsys.readouterr()
        assert run(tmp_path, f"brake-cal {line} --json") == 0, line
        wrong += missing_and_unknown(name, json.loads(capsys.readouterr().out))
    assert wrong == []


@pytest.mark.parametrize("name", documents())
def test_a_schema_is_valid(name):
    document = documents()[name]
    Draft202012Validator.check_schema(document.schema)
    assert document.keys
    assert re.search(r"brake-cal|\.json$", document.schema["title"])
