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


FADING = """schema = 1
[empirical]
place = "rear_brakes"
driver = "temperature"
knots = [0.0, 500.0]
values = [0.0, -0.5]
"""


def test_a_temperature_that_the_log_lacks_is_bad_input(brake_cal, model, tmp_path):
    """None of these logs has a disc temperature, and none is guessed."""
    model.write_text(FADING)
    store, sim = tmp_path / "tables", tmp_path / "sim.csv"
    sedan = sample_logs() / "sedan"
    ramp, stop = sedan / "ramp_wet_asphalt.csv", sedan / "dry_asphalt_stop.csv"
    vehicle = ("--vehicle", sedan / "vehicle.toml")
    assert brake_cal("fit", ramp, *vehicle, "--store", store).code == 0
    for log, words in (
        (ramp, ("fit", ramp, *vehicle, "--store", tmp_path / "other")),
        (stop, ("validate", "sedan-2up", stop, "--store", store)),
        (stop, ("simulate", stop, *vehicle, "--out", sim)),
    ):
        ran = brake_cal(*words, "--model", model)
        assert ran.code == 3
        assert "T_disc_r" in ran.err
        assert log.stem in ran.err
    assert not sim.exists()
    assert not (tmp_path / "other").exists()


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
