"""`fit --model` and `validate --model`: what a diagnosis found is known beforehand."""

import json

import pytest

from calib.demo.samples import sample_logs

CASE = sample_logs() / "hidden" / "case_3"
RAMP, COAST = (CASE / "calibration" / f"{name}.parquet" for name in ("ramp", "coast"))
STOP = CASE / "holdout" / "stop_b.parquet"
VALVE = """schema = 1
[effects.rear_proportioning]
knee = "13.57 bar"
knee_slope = 0.334
"""


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(VALVE)
    return path


def test_the_table_keeps_what_was_known(brake_cal, model, tmp_path):
    store = tmp_path / "tables"
    fitted = brake_cal(
        *("fit", RAMP, COAST, "--vehicle", CASE / "vehicle.toml", "--model", model),
        *("--store", store, "--json"),
    )
    assert fitted.code == 0, fitted.err
    said = json.loads(fitted.out)
    assert "known effects taken out of the logs: rear_proportioning" in said["remarks"]
    told = brake_cal("validate", "suv-d", STOP, "--store", store, "--json")
    again = brake_cal("validate", "suv-d", STOP, "--store", store, "--model", model, "--json")
    assert told.code == again.code == 0
    assert json.loads(told.out) == json.loads(again.out)


def test_a_slip_in_the_model_is_named(brake_cal, model, tmp_path):
    model.write_text(VALVE.replace("rear_prop", "raer_prop"))
    ran = brake_cal(
        *("fit", RAMP, "--vehicle", CASE / "vehicle.toml", "--model", model),
        *("--store", tmp_path / "tables"),
    )
    assert ran.code == 3
    assert "raer_proportioning" in ran.err
    assert "rear_proportioning" in ran.err.replace("raer_proportioning", "")
    assert not (tmp_path / "tables").exists()
