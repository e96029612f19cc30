"""`brake-cal effects`, `schema`, `manual`, `qualify`, `limits`, and the Tab key."""

import json
from pathlib import Path

import pytest

from calib.base.plain import METRICS
from calib.base.warning import RULES
from calib.car import forces
from calib.car.effects.catalogue import CATALOGUE
from calib.estimation.reasons import CHECKS
from calib.help import qualify
from calib.help.documents import FILES, documents
from calib.help.explain import codes, explained
from calib.help.page import contents
from tests.cli.conftest import parsed

ROOT = Path(__file__).parents[2]


def test_every_effect_has_its_line_and_its_card(brake_cal):
    lines = brake_cal("effects").out.splitlines()
    assert all(any(line.startswith(f"{name} ") for line in lines) for name in CATALOGUE)
    cards = parsed(brake_cal("effects", "--json"))["effects"]
    assert [card["name"] for card in cards] == list(CATALOGUE)
    (card,) = parsed(brake_cal("effects", "rear_proportioning", "--json"))["effects"]
    units = {p["name"]: p["unit"] for p in card["parameters"]}
    assert units == {"knee_slope": "1", "knee": "Pa"}
    out = brake_cal("effects", "rear_proportioning").out
    assert card["equation"] in out
    assert all(p["name"] in out for p in card["parameters"])


def test_schemas_are_listed_and_those_of_documents_printed(brake_cal):
    listed = parsed(brake_cal("schema", "--json"))
    assert (list(listed["files"]), list(listed["documents"])) == ([*FILES], [*documents()])
    assert len(brake_cal("schema").out.splitlines()) == len(FILES) + len(documents())
    assert parsed(brake_cal("schema", "fit-json")) == documents()["fit-json"].schema


def test_the_manual_is_listed_and_each_page_printed(brake_cal):
    assert [p["name"] for p in parsed(brake_cal("manual", "--json"))["pages"]] == [*contents()]
    assert parsed(brake_cal("manual", "ramp", "--json"))["text"].startswith("# ")
    assert brake_cal("manual", "xyzzy").code == 2


@pytest.mark.parametrize("code", ["a_x_scale", "ecu_reference_f", "IMPLAUSIBLE", "motor_changed"])
def test_a_code_is_explained_by_its_own_row(brake_cal, code):
    document = parsed(brake_cal("manual", code, "--json"))
    assert parsed(brake_cal("explain", code, "--json")) == document
    text = " ".join(document["text"])
    advice = [rule.do for rule in RULES if rule.code == code]
    expected = advice or [CHECKS.get(code) or getattr(METRICS.get(code), "meaning", "")]
    assert all(words in text for words in expected)
    assert text


def test_every_code_says_something():
    assert all(explained(code).rows for code in codes())


def test_limits_are_written_as_they_are_printed(brake_cal, tmp_path):
    path = tmp_path / "line.toml"
    assert brake_cal("limits", "--out", path).code == 0
    assert brake_cal("limits").out == path.read_text()
    rows = {row["limit"]["figure"]: row for row in parsed(brake_cal("limits", "--json"))["limits"]}
    assert rows["pad_scale"]["limit"]["high"] == 1.2


def test_qualify_finds_what_is_wrong(brake_cal, tmp_path, monkeypatch):
    assert parsed(ran := brake_cal("qualify", "--json"))["findings"]
    assert ran.code == brake_cal("qualify").code == 0
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("BRAKE_CAL_SETTINGS", raising=False)
    (tmp_path / "brake-cal.toml").write_text("[")
    ran = brake_cal("qualify", "--json")
    wrong = [x["name"] for x in parsed(ran)["findings"] if x["state"] == "wrong"]
    assert (ran.code, wrong) == (1, ["settings"])


def test_qualify_writes_what_holds_and_what_does_not(brake_cal, tmp_path, monkeypatch):
    """Closed forms only; `tests/help/test_qualify.py` makes all checks."""
    monkeypatch.setattr(qualify, "SUITE", dict(list(qualify.SUITE.items())[:1]))
    assert parsed(ran := brake_cal("qualify", "--out", tmp_path, "--json"))["verdict"] == "passed"
    assert ran.code == 0
    assert parsed(ran) == json.loads((tmp_path / "qualification.json").read_text())
    assert (tmp_path / "qualification.html").is_file()
    right = forces.brake_torque
    monkeypatch.setattr(forces, "brake_torque", lambda *given: 1.01 * right(*given))
    ran = brake_cal("qualify", "--out", tmp_path, "--json")
    assert ran.code == 1
    assert [c["name"] for c in parsed(ran)["checks"] if not c["held"]] == ["brake_torque"]
