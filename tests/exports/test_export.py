import hashlib
from datetime import UTC, datetime

import pytest

from calib.base.errors import ExchangeError
from calib.exports.export import export


@pytest.mark.parametrize(
    ("name", "form", "begins"),
    [
        ("car.dcm", "dcm", b'* encoding="UTF-8"'),
        ("car.h", "c-header", b"/*"),
        ("car.a2l", "a2l", b"ASAP2_VERSION 1 71"),
        ("car.inca.csv", "inca-csv", b"CALIBRATION VALUES"),
        ("car.JSON", "json", b"{"),
        ("car.parquet", "parquet", b"PAR1"),
    ],
)
def test_the_ending_names_the_format(stored, tmp_path, name, form, begins):
    written = export(stored, str(tmp_path / name))
    content = (tmp_path / name).read_bytes()
    assert written.form == form
    assert content.startswith(begins)
    assert written.content == content
    assert written.sha256 == hashlib.sha256(content).hexdigest()
    assert repr(written) == f"{tmp_path / name}: sedan@1 as {form}, {len(content)} bytes"


def test_a_format_that_is_given_goes_before_the_ending(stored, tmp_path):
    assert export(stored, tmp_path / "car.txt", "DCM").form == "dcm"


def test_a_cdfx_has_the_date_that_is_given_or_today(stored, tmp_path):
    given = export(stored, tmp_path / "a.cdfx", date="2025-03-31").content
    assert b"2025-03-31" in given
    before = datetime.now(UTC).date().isoformat()
    content = export(stored, tmp_path / "b.cdfx").content
    assert any(day.encode() in content for day in (before, datetime.now(UTC).date().isoformat()))


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("car.txt", {}, r"car\.txt: its ending names no format; expected one of \.json"),
        ("car.dcm", {"form": "dmc"}, "unknown format 'dmc'; did you mean 'dcm'"),
        ("car.dcm", {"bits": 16}, "dcm has no fixed point; expected c-header"),
        ("car.h", {"elf": "ecu.elf"}, "c-header has no addresses; expected a2l"),
        ("car.dcm", {"points": 99}, "99 breakpoints; expected"),
    ],
)
def test_what_cannot_be_written_is_refused_and_nothing_is_there(
    stored, tmp_path, name, options, says
):
    with pytest.raises(ExchangeError, match=says):
        export(stored, tmp_path / name, **options)
    assert not (tmp_path / name).exists()
