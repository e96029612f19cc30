import json

import pytest

from calib.car import forces
from calib.help import checks

SHORT = checks.SUITE[:6]


@pytest.fixture(autouse=True)
def short(monkeypatch):
    """Closed forms only; `tests/help/test_checks.py` makes all checks."""
    monkeypatch.setattr(checks, "SUITE", SHORT)


@pytest.mark.smoke
def test_it_writes_a_page_and_a_document(brake_cal, tmp_path):
    out = tmp_path / "qualification"
    ran = brake_cal("qualify", "--out", out)
    assert ran.code == 0
    assert ran.out.startswith(f"All {len(SHORT)} checks hold.")
    assert {path.name for path in out.iterdir()} == {"qualification.json", "qualification.html"}
    document = json.loads((out / "qualification.json").read_text())
    assert document["verdict"] == "passed"
    assert document["digest"] in ran.out
    assert document["digest"] in (out / "qualification.html").read_text()


def test_a_check_that_does_not_hold_ends_with_1_and_is_written(brake_cal, tmp_path, monkeypatch):
    right = forces.brake_torque
    monkeypatch.setattr(forces, "brake_torque", lambda *given: 1.01 * right(*given))
    ran = brake_cal("qualify", "--out", tmp_path, "--json")
    assert ran.code == 1
    document = json.loads(ran.out)
    assert document == json.loads((tmp_path / "qualification.json").read_text())
    assert [c["name"] for c in document["checks"] if not c["held"]] == ["brake_torque"]


def test_a_file_in_place_of_the_folder_is_refused(brake_cal, tmp_path):
    (tmp_path / "taken").write_text("")
    assert brake_cal("qualify", "--out", tmp_path / "taken").code == 2
