import hashlib
from dataclasses import replace

import pytest

from calib.base.errors import ExchangeError, StoreError
from calib.car.effects.effects import Effects
from calib.exports.export import ENDINGS, export


@pytest.mark.parametrize("form", ENDINGS)
def test_the_ending_names_the_format(stored, tmp_path, form):
    written = export(stored, str(tmp_path / f"car.{ENDINGS[form]}".upper()))
    content = written.path.read_bytes()
    assert (written.form, written.content) == (form, content)
    assert written.to_dict()["sha256"] == hashlib.sha256(content).hexdigest()
    assert export(stored, tmp_path / "car.txt", form.upper()).form == form


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("car.txt", {}, "its ending names no format"),
        ("car.dcm", {"form": "dmc"}, "did you mean 'dcm'"),
        ("car.dcm", {"bits": 16}, "expected a2l, c-header"),
        ("car.h", {"elf": "ecu.elf"}, "expected a2l"),
        ("car.dcm", {"points": 99}, "99 breakpoints"),
    ],
)
def test_what_cannot_be_written_is_refused_and_nothing_is_there(
    stored, tmp_path, name, options, says
):
    with pytest.raises(ExchangeError, match=says):
        export(stored, tmp_path / name, **options)
    assert not list(tmp_path.glob("car*"))


FADING = {"pad_thermal_fade": {"fade_slope": 1e-3, "fade_onset": 150.0}}


def with_effects(stored, parameters):
    car = replace(stored.table.vehicle, effects=Effects(parameters))
    return replace(stored, table=replace(stored.table, vehicle=car))


@pytest.mark.parametrize("form", ENDINGS)
def test_an_effect_that_no_ecu_senses_is_refused_until_it_is_named(stored, tmp_path, form):
    fades = with_effects(stored, {**FADING, "hydraulic_lag": {"time_constant": 0.1}})
    path = tmp_path / f"car.{ENDINGS[form]}"
    with pytest.raises(StoreError, match="pad_thermal_fade"):
        export(fades, path)
    assert not path.exists()
    written = export(fades, path, without_effects=["pad_thermal_fade"])
    assert b"pad_thermal_fade" in written.content
    assert b"hydraulic_lag" in written.content
    assert "hydraulic_lag" not in written.data.facts()["effects not known to the ECU"]


def test_a_name_of_no_such_effect_is_refused(stored, tmp_path):
    lags = with_effects(stored, {"hydraulic_lag": {"time_constant": 0.1}})
    for version, name in ((stored, "pad_thermal_fade"), (lags, "hydraulic_lag")):
        with pytest.raises(ExchangeError, match=name):
            export(version, tmp_path / "car.dcm", without_effects=[name])
    assert export(lags, tmp_path / "car.dcm").path.exists()
