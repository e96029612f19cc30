"""The demo, and in its folder every example that a help text prints, and the README's commands."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import matplotlib.image
import numpy as np
import pandas as pd
import pytest
import typer.main

from calib.help.demo import STEPS
from calib.help.samples import sample_logs
from calib.store.store import Store
from cli.groups import Group
from cli.main import app
from tests.support import sample_store
from tests.support.manual import run

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the demo leaves, made once."""
    folder = tmp_path_factory.mktemp("newcomer")
    assert run(folder, "brake-cal demo") == 0
    return folder / "brake-cal-demo"


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the examples of the help texts need of the demo: sample logs, tables, a validation."""
    folder = tmp_path_factory.mktemp("home")
    (folder / "sample_logs").symlink_to(sample_logs())
    shutil.copytree(sample_store.STORE, folder / "tables")
    judged = "brake-cal validate sedan-2up@2 sample_logs/sedan/dry_asphalt_stop.csv"
    assert run(folder, f"{judged} --out results/sedan") == 0
    return folder


def examples() -> list[str]:
    """Every line that a help text prints as an example, but the demo itself."""

    def lines(command) -> list[str]:
        in_epilog = re.findall(r"^ *(brake-cal .*)$", command.epilog or "", re.MULTILINE)
        inner = command.list_commands(None) if isinstance(command, Group) else []
        return in_epilog + [x for name in inner for x in lines(command.get_command(None, name))]

    # a gauge study needs ramps of several cars, which the samples lack: see test_repeatability.py;
    # a watch does not end by itself: see test_watch.py
    # a mean needs tables of several cars: see test_merge.py
    untested = ("demo", "brake-cal repeatability", "brake-cal watch", "brake-cal tables merge")
    printed = lines(typer.main.get_command(app))
    return [*dict.fromkeys(x for x in printed if not any(part in x for part in untested))]


def readme_commands() -> list[str]:
    """The commands for one's own car."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    section = text.split("## Your own car")[1].split("```")[1]
    return [line for line in section.splitlines() if line.startswith("brake-cal ")]


@pytest.mark.slow
def test_the_demo_leaves_logs_tables_results_and_figures(demo: Path) -> None:
    folders = {"sample_logs", "tables", "results", "figures", "pages", "diagnosis"}
    assert {p.name for p in demo.iterdir()} == {*folders, "index.html"}
    diagnosis = json.loads((demo / "diagnosis/diagnosis.json").read_text())
    hidden = json.loads((sample_logs() / "hidden/case_2/answer.json").read_text())
    assert [effect["name"] for effect in diagnosis["effects"]] == hidden["effects"]
    for summary in demo.glob("results/*/summary.json"):
        document = json.loads(summary.read_text())
        for log in document["logs"]:
            frame = pd.read_parquet(summary.parent / f"{log['log']}.parquet")
            assert len(frame) > 1000
    assert (demo / "tables/sedan-2up/v0002/record.json").is_file()
    for figure in demo.glob("figures/*.png"):
        assert figure.read_bytes()[:4] == b"\x89PNG"
    text = (demo / "index.html").read_text(encoding="utf-8")
    assert text.count("data:image/png") == len([*demo.glob("figures/*.png")])
    links = re.findall('<a href="([^"]+)"', text)
    assert all((demo / link).exists() for link in links)
    assert {*links} >= {str(p.relative_to(demo)) for p in demo.glob("pages/*.html")}
    drawn = {n for x in links if x.startswith("figures") for n in re.findall(r"\d+", x)}
    assert drawn == {str(n) for n in (*range(2, 7), *range(8, 12), *range(13, 17))}


def test_a_command_of_the_demo_with_another_answer_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    steps = (*STEPS[:2], replace(STEPS[0], expected="another answer"))
    monkeypatch.setattr("calib.help.demo.STEPS", steps)
    assert run(tmp_path, "brake-cal demo --json") == 1
    answers = json.loads(capsys.readouterr().out)["steps"]
    assert [answer["passed"] for answer in answers] == [True, True, False]
    assert (tmp_path / "brake-cal-demo/index.html").is_file()


@pytest.mark.slow
def test_the_tables_and_pictures_of_the_repository_are_those_of_the_program(demo: Path) -> None:
    repository, fresh = Store(sample_store.STORE), Store(demo / "tables")
    assert [entry.id for entry in repository.entries()] == [entry.id for entry in fresh.entries()]
    for entry in repository.entries():
        expected, actual = repository.load(entry.id).table, fresh.load(entry.id).table
        assert expected.provenance.logs == actual.provenance.logs
        for part in ("paper", "tyre", "level_map", "map"):
            for name, values in vars(getattr(expected, part)).items():
                computed = getattr(getattr(actual, part), name)
                scale = np.max(np.abs(values))
                assert computed == pytest.approx(values, abs=0.02 * scale), (entry.id, part, name)
    sample_store.draw(demo)
    for name in sample_store.PICTURES:
        expected, actual = (
            matplotlib.image.imread(path)[..., :3]
            for path in (sample_store.picture(name), demo / "figures" / f"{name}.png")
        )
        assert expected.shape == actual.shape
        assert np.mean(np.abs(expected - actual)) < 0.01, name


SLOW = re.compile("brake-cal (batch|diagnose|fleet|plan|qualify|station)")
"""Commands of up to half a minute; they also run on pages of the manual and in their tests."""

MAKERS = (
    ("simulate ramp.csv", "--manoeuvre ramp"),
    ("tables export", "tables release"),
    ("tables compare", "--out sedan.dcm"),
    ("--limits line.toml", "brake-cal limits"),
    ("fleet runs", "--out runs/car-0815"),
    ("tables sign sedan", "--new-key"),
    ("fleet checked", "--out checked"),
)
"""A part of an example, and a part of the example that makes what the first one reads."""


def with_makers(line: str) -> list[str]:
    """Return the examples that make what an example reads, and then this example."""
    makers = [next(x for x in examples() if part in x) for mark, part in MAKERS if mark in line]
    return [y for x in makers for y in with_makers(x)] + [line]


@pytest.mark.parametrize(
    "line", [pytest.param(x, marks=pytest.mark.slow if SLOW.match(x) else ()) for x in examples()]
)
def test_the_examples_work_as_printed(home: Path, line: str) -> None:
    for example in with_makers(line):
        # what another example has written is not replaced
        names = ("line.key", "line.pub") if "--new-key" in example else ("line.toml", "sedan.dcm")
        for name in names:
            is_read = f"--limits {name}" in example or "compare" in example
            if f" {name}" in example and not is_read:
                (home / name).unlink(missing_ok=True)
        assert run(home, example) == 0


def test_the_commands_of_the_readme_work(tmp_path: Path) -> None:
    source = sample_logs() / "sedan"
    for name, copy in (
        ("ramp_wet_asphalt.csv", "ramp.csv"),
        ("coast.csv", "coast.csv"),
        ("basalt_wet_pads.csv", "stop.csv"),
    ):
        shutil.copy(source / name, tmp_path / copy)
    vehicle = (source / "vehicle.toml").read_text().replace("sedan-2up", "car")
    (tmp_path / "car.toml").write_text(vehicle)
    lines = readme_commands()
    assert len(lines) == 3
    for line in lines:
        assert run(tmp_path, line) == 0, line
    assert (tmp_path / "tables/car/v0001/record.json").is_file()
    assert (tmp_path / "results/stop.parquet").is_file()
