"""Outputs that are refused before the work."""

from contextlib import nullcontext
from pathlib import Path

import pytest
import typer

from cli.outputs import (
    ready_folder,
    refuse_folder,
    refuse_foreign,
    refuse_overwriting,
    stems_of,
    writing,
)


def test_a_file_where_a_folder_is_meant(tmp_path):
    ready_folder(None)
    ready_folder(tmp_path)
    ready_folder(tmp_path / "new")
    (tmp_path / "file").touch()
    with pytest.raises(typer.BadParameter, match="is a file"):
        ready_folder(tmp_path / "file")


def test_a_folder_in_the_place_of_a_file_of_the_folder(tmp_path):
    (tmp_path / "summary.json").mkdir()
    ready_folder(tmp_path, ["a.parquet"])
    with pytest.raises(
        typer.BadParameter, match=r"cannot write .*summary\.json: it is a directory"
    ):
        ready_folder(tmp_path, ["a.parquet", "summary.json"])


def test_what_a_killed_run_left_is_settled_and_told(tmp_path, capsys):
    (tmp_path / ".making-0123").mkdir()
    ready_folder(tmp_path)
    assert not list(tmp_path.iterdir())
    assert "a run that was killed" in capsys.readouterr().err
    ready_folder(tmp_path)
    assert capsys.readouterr().err == ""


def test_a_folder_where_a_file_is_meant(tmp_path):
    refuse_folder(tmp_path / "new.csv")
    refuse_folder(tmp_path / "none" / "new.csv")
    with pytest.raises(typer.BadParameter, match="it is a directory"):
        refuse_folder(tmp_path)


@pytest.mark.parametrize("refuse", [refuse_folder, ready_folder])
def test_a_file_in_the_place_of_a_folder_above(tmp_path, refuse):
    (tmp_path / "file").touch()
    with pytest.raises(typer.BadParameter, match="file is a file, not a directory"):
        refuse(tmp_path / "file" / "below" / "new")


def test_folders_above_are_made_and_gone_again_if_nothing_was_written(tmp_path):
    out = tmp_path / "a" / "b" / "new.csv"
    with pytest.raises(KeyError), writing(out):
        raise KeyError(out.parent.is_dir())
    assert list(tmp_path.iterdir()) == []
    with writing(out):
        out.write_text("x")
    assert out.is_file()


def test_where_nothing_can_be_forced_another_name_is_asked_for(tmp_path):
    (tmp_path / "x").write_text("other")
    with pytest.raises(typer.BadParameter, match="not a page; give another name") as error:
        refuse_foreign(tmp_path / "x", lambda data: False, "a page", None, "--report")
    assert error.value.param_hint == "--report"


@pytest.mark.parametrize(
    ("content", "force", "refused"),
    [
        (None, False, False),
        ("", False, False),
        ("ours", False, False),
        ("other", False, True),
        ("other", True, False),
    ],
)
def test_only_our_own_files_are_replaced(tmp_path, content, force, refused):
    out = tmp_path / "x"
    if content is not None:
        out.write_text(content)
    expected = pytest.raises(typer.BadParameter, match="is not a result; --force replaces it")
    with expected if refused else nullcontext():
        refuse_foreign(out, lambda data: data == b"ours", "a result", force)


@pytest.mark.parametrize(
    ("output", "says"),
    [
        ("new.csv", None),
        ("a.csv", "would overwrite the log a.csv"),
        ("sub/../a.csv", "would overwrite the log a.csv"),
        ("car.toml", "would overwrite car.toml"),
    ],
)
def test_an_output_that_is_an_input(tmp_path, monkeypatch, output, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    refused = pytest.raises(typer.BadParameter, match=f"^{says}$") if says else nullcontext()
    with refused:
        refuse_overwriting([Path(output)], [Path("a.csv")], [None, Path("car.toml")])


def test_logs_of_one_stem(tmp_path):
    paths = [tmp_path / name for name in ("a.csv", "b.csv.gz", "c.parquet")]
    assert stems_of(paths, "LOG") == ["a", "b", "c"]
    with pytest.raises(typer.BadParameter, match="two stops are named b, and --out") as error:
        stems_of([*paths, tmp_path / "b.vbo"], "LOG", "stops")
    assert error.value.param_hint == "LOG"


def test_what_cannot_be_written_names_the_place(tmp_path):
    refused = pytest.raises(typer.BadParameter, match=r"a.txt cannot be written \(No such file")
    with refused, writing(tmp_path / "a.txt"):
        (tmp_path / "none" / "a.txt").write_text("a")
