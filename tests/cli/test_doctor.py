"""`brake-cal doctor` as the shell runs it."""

import json

import pytest

from calib import __version__


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_it_can_work_where_the_tests_run(brake_cal):
    ran = brake_cal("doctor")
    assert ran.code == 0
    assert ran.out.splitlines()[0] == f"brake-cal {__version__} can work here"
    assert "no brake-cal.toml" in ran.out


def test_json(brake_cal):
    document = json.loads(brake_cal("doctor", "--json").out)
    assert (document["schema"], document["verdict"]) == (1, "fine")
    names = [one["name"] for one in document["findings"]]
    for name in ("python", "numpy", "[mdf]", "font", "cores", "store", "settings", "output"):
        assert name in names


def test_what_is_wrong_is_named_and_ends_with_1(brake_cal, tmp_path):
    (tmp_path / "brake-cal.toml").write_text("schema = 1\nstroe = 'x'\n")
    (tmp_path / "file").touch()
    ran = brake_cal("doctor", "--store", "file")
    assert ran.code == 1
    assert ran.out.splitlines()[0].endswith("cannot work here: store, settings")
    assert "did you mean 'store'" in ran.out
