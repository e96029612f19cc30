"""A format that needs a library says what to install."""

import sys

import pytest

from calib.base.errors import LogError
from calib.logs.source import need
from tests.support.recordings import write_bus, write_dbc, write_map, write_mdf


def test_it_is_not_there():
    with pytest.raises(LogError, match=r"pip install 'brake-cal\[can\]'") as error:
        need("no_such_library", "can", "run.blf")
    assert "run.blf" in str(error.value)


@pytest.mark.parametrize(
    ("name", "missing", "extra"),
    [
        ("run.mf4", "asammdf", "mdf"),
        ("bus.mf4", "cantools", "mdf"),
        ("run.blf", "can", "can"),
    ],
)
def test_the_user_reads_one_line(tmp_path, brake_cal, monkeypatch, name, missing, extra):
    path = tmp_path / name
    chart = write_map(tmp_path) if name == "run.mf4" else write_dbc(tmp_path)
    write_mdf(path) if name == "run.mf4" else write_bus(path)
    monkeypatch.setitem(sys.modules, missing, None)
    ran = brake_cal("check", path, "--map", chart)
    assert ran.code == 3
    assert f"pip install 'brake-cal[{extra}]'" in ran.err
    assert len(ran.err.splitlines()) == 1
