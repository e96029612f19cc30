"""The model file: values in SI, defaults, exact reading back, and mistakes that are refused."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import ModelError
from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.model import WET_ASPHALT, Model, default_model
from calib.car.model_file import read_model, write_model
from calib.car.tyre import MagicFormula
from calib.car.vehicle_file import read_vehicle
from tests.support.refusals import refusal

SEDAN = read_vehicle(Path(__file__).parents[2] / "sample_logs/sedan/vehicle.toml")
KNOWN = replace(SEDAN, effects=Effects({"rolling_resistance": {"coefficient": 0.012}}))

FULL = """
schema = 1
[pads]
front = 0.30
rear = "34 %"
[tyre]
stiffness = 20.0
peak = 0.5
shape = 1.5
load_exponent = 0.1
bend = 0.3
relaxation = "25 cm"
peak_exponent = 0.04
[effects.aerodynamic_drag]
drag_area = "6600 cm^2"
"""


def read(tmp_path, text, vehicle=SEDAN):
    path = tmp_path / "model.toml"
    path.write_text(text)
    return read_model(path, vehicle)


def test_reads_every_section_in_si(tmp_path):
    model = read(tmp_path, FULL, KNOWN)
    assert (model.pad_friction_f, model.pad_friction_r) == (0.30, pytest.approx(0.34))
    assert model.tyre == MagicFormula(20.0, 0.5, 1.5, 0.1, 0.3, 0.25, 0.04)
    drag = {"drag_area": pytest.approx(0.66), "load_share": 1.0}  # (6) where it is not given
    assert model.effects == Effects({"aerodynamic_drag": drag})


def test_what_is_left_out_is_the_default(tmp_path):
    assert read(tmp_path, "schema = 1", KNOWN) == default_model(KNOWN)
    model = read(tmp_path, "schema = 1\n[tyre]\npeak = 0.4\n[pads]\nrear = 0.3", KNOWN)
    assert model.tyre == replace(WET_ASPHALT, peak=0.4)
    assert (model.pad_friction_f, model.pad_friction_r) == (0.38, 0.3)


TERMS = (
    EmpiricalTerm("rear_brakes", "temperature", (20.0, 1e2 / 3), (0.0, -1e-7)),
    EmpiricalTerm("body", "constant", (0.0,), (0.01,)),
)


@given(st.lists(st.floats(0.05, 0.9), min_size=9, max_size=9), st.integers(0, 2))
def test_written_and_read_back_it_is_the_same(tmp_path_factory, x, parts):
    tyre = MagicFormula(30.0 * x[0] + 1.0, x[1], 1.05 + x[2], x[3], x[4], x[5], -x[6])
    named = {
        "rolling_resistance": {"coefficient": 0.01 * x[7], "rolling_growth": -0.1},
        "aerodynamic_drag": {"drag_area": x[8], "load_share": 1.0},
    }
    effects = Effects(named if parts else {}, TERMS[:parts])
    model = Model(KNOWN, x[7], x[8], tyre, effects)
    path = tmp_path_factory.mktemp("model") / "model.toml"
    write_model(model, path)
    assert read_model(path, KNOWN) == model


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("drag_area", "drag_aera", "did you mean 'drag_area'"),
        ('drag_area = "6600 cm^2"', "", "'drag_area' is missing"),
        ("6600 cm^2", "-1 m^2", "drag_area: -1 m^2 is not believable; expected 0 to 12 m^2"),
        ("shape = 1.5", "shape = 2.5", "tyre.shape: 2.5 is not believable"),
    ],
)
def test_refuses_and_says_what_is_wrong(tmp_path, old, new, words):
    assert old in FULL
    message = refusal(read, tmp_path, FULL.replace(old, new, 1), kind=ModelError)
    assert words in message
    assert "model.toml" in message
