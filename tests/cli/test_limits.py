"""`brake-cal limits init`."""

import json


def test_written_printed_and_used(brake_cal, tmp_path):
    path = tmp_path / "line.toml"
    assert brake_cal("limits", "init", "--out", path).code == 0
    assert brake_cal("limits", "init").out == path.read_text()
    stop = "sample_logs/sedan/dry_asphalt_stop.csv"
    assert brake_cal("validate", "sedan-2up", stop, "--limits", path).code == 0


def test_an_edited_file_is_not_replaced_unless_told(brake_cal, tmp_path):
    path = tmp_path / "line.toml"
    path.write_text("mine")
    assert brake_cal("limits", "init", "--out", path).code == 2
    assert path.read_text() == "mine"
    assert brake_cal("limits", "init", "--out", path, "--force").code == 0
    assert brake_cal("limits", "init", "--out", tmp_path).code == 2


def test_limits_of_a_car_alone_judge_no_stop(brake_cal, tmp_path):
    path = tmp_path / "car.toml"
    path.write_text("schema = 1\n[limits]\npad_scale = { min = 0.8 }\n")
    stop = "sample_logs/sedan/dry_asphalt_stop.csv"
    ran = brake_cal("validate", "sedan-2up", stop, "--limits", path)
    assert ran.code == 3
    assert "no limit for a stop" in ran.err


def test_as_a_document(brake_cal):
    document = json.loads(brake_cal("limits", "init", "--json").out)
    rows = {row["limit"]["figure"]: row for row in document["limits"]}
    assert rows["pad_scale"]["limit"]["high"] == 1.2
    assert all(row["reason"] and row["action"] and row["unit"] for row in rows.values())
