"""Effects of the user belong to a car, a model or a table; a missing file is an error."""

from dataclasses import replace

import pytest

from calib.base.errors import ModelError
from calib.car.effects.catalogue import CATALOGUE, all_effects, definition, with_own
from calib.car.effects.combined import total_axle_moment
from calib.car.effects.effect_file import read_own_effects
from calib.car.effects.effects import Effects
from calib.car.model import default_model
from calib.car.model_file import read_model, write_model
from tests.support.effect_runs import SEDAN, made_motion
from tests.support.own_effects import EXAMPLE
from tests.support.tables import from_content, made_table

FLAP = read_own_effects([EXAMPLE])[0]
EQUIPPED = with_own(SEDAN, [FLAP])
ACTING = {"air_brake_flap": {"flap_area": 0.5}}
MODEL = replace(
    default_model(EQUIPPED), effects=Effects(ACTING, user_defined=EQUIPPED.effects.user_defined)
)


def test_a_car_that_has_a_file_has_its_effect_and_another_car_has_not():
    assert definition(EQUIPPED.effects, "air_brake_flap") is FLAP.effect
    assert list(all_effects(EQUIPPED.effects)) == [*CATALOGUE, "air_brake_flap"]
    assert list(all_effects(SEDAN.effects)) == list(CATALOGUE)
    with pytest.raises(ModelError, match=r"unknown effect 'air_brake_flap'.*give --effect FILE"):
        definition(SEDAN.effects, "air_brake_flap")


# A model file ------------------------------------------------------------------------------------


@pytest.fixture
def model_file(tmp_path):
    path = tmp_path / "model.toml"
    write_model(MODEL, path)
    return path


def test_a_model_is_read_back_exactly_where_the_file_is_given(model_file):
    assert read_model(model_file, EQUIPPED) == MODEL


def test_a_model_without_the_file_is_refused_and_names_file_and_option(model_file):
    with pytest.raises(ModelError) as caught:
        read_model(model_file, SEDAN)
    for part in ("model.toml", "'air_brake_flap'", "give --effect air_brake_flap.py"):
        assert part in str(caught.value)


def test_a_changed_effect_file_is_refused_unless_the_model_has_no_digest(model_file, tmp_path):
    changed = tmp_path / "air_brake_flap.py"
    changed.write_text(EXAMPLE.read_text() + "\n# more\n")
    car = with_own(SEDAN, read_own_effects([changed]))
    with pytest.raises(ModelError, match=r"air_brake_flap\.py has changed since"):
        read_model(model_file, car)
    lines = [line for line in model_file.read_text().splitlines() if "sha256" not in line]
    model_file.write_text("\n".join(lines))
    assert read_model(model_file, car).effects.parameters == ACTING


# A table -----------------------------------------------------------------------------------------


def test_the_record_of_a_table_holds_name_and_digest_and_no_code():
    table = made_table()
    plain = table.content()[0]
    assert "own_effects" not in plain
    table = replace(table, vehicle=replace(table.vehicle, effects=MODEL.effects))
    record, curves = table.content()
    assert record["own_effects"] == {
        "air_brake_flap": {"file": "air_brake_flap.py", "sha256": FLAP.sha256}
    }
    read = from_content(record, curves)
    assert read.digest == table.digest
    with pytest.raises(ModelError, match=r"defined in air_brake_flap\.py, which was not given"):
        total_axle_moment(read.vehicle, read.vehicle.effects, made_motion([30.0]))
    with_file = replace(read, vehicle=with_own(read.vehicle, [FLAP]))
    assert with_file.digest == table.digest
    assert default_model(with_file.vehicle).effects.parameters == ACTING
