"""Logs that patterns, folders and paths name."""

from pathlib import Path

import pytest

from calib.base.errors import LogError
from calib.line.fleet.batch import find_logs


@pytest.fixture(autouse=True)
def tree(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a.csv", "deep/er/b.PARQUET", "deep/c.csv", ".hidden.csv", ".git/d.csv", "x.md"):
        path = Path("logs", name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()


def logs_of(*arguments, out="out"):
    return list(find_logs(arguments, Path(out)))


def test_a_folder_is_all_logs_below_it():
    assert logs_of("logs") == ["logs/a.csv", "logs/deep/c.csv", "logs/deep/er/b.PARQUET"]


def test_patterns_and_paths_as_given(tmp_path):
    assert logs_of("logs/*.csv") == ["logs/a.csv"]
    assert logs_of("logs/**/*.csv") == ["logs/a.csv", "logs/deep/c.csv"]
    assert logs_of(str(tmp_path / "logs/a.csv"), "logs/gone.csv") == [
        str(tmp_path / "logs/a.csv"),
        "logs/gone.csv",
    ]
    Path("logs/[1].csv").touch()
    assert logs_of("logs/[1].csv") == ["logs/[1].csv"]


@pytest.mark.parametrize("argument", ["nolog", "logs/*.mf4"])
def test_what_names_no_log_is_told(argument):
    with pytest.raises(LogError):
        logs_of("logs", argument)


def test_results_among_the_logs_are_no_logs():
    Path("logs/out").mkdir()
    Path("logs/out/results.parquet").touch()
    assert "logs/out/results.parquet" not in logs_of("logs", out="logs/out")
    assert "logs/out/results.parquet" not in logs_of("logs/**/*.*", "logs", out="logs/out")
