import hashlib

import pytest

from calib.base.errors import ExchangeError
from calib.exports.export import ENDINGS, export


@pytest.mark.parametrize("form", ENDINGS)
def test_the_ending_names_the_format(stored, tmp_path, form):
    written = export(stored, str(tmp_path / f"car.{ENDINGS[form]}".upper()))
    content = written.path.read_bytes()
    assert (written.form, written.content) == (form, content)
    assert written.to_dict()["sha256"] == hashlib.sha256(content).hexdigest()
    assert export(stored, tmp_path / "car.txt", form.upper()).form == form


def test_a_cdfx_has_the_date_that_is_given(stored, tmp_path):
    assert b"2025-03-31" in export(stored, tmp_path / "a.cdfx", date="2025-03-31").content


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
