"""Completion as a shell asks for it, by variables of the environment."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from cli.schema import SCHEMAS

from calib.car.effects.catalogue import CATALOGUE
from calib.help.documents import documents
from tests.test_layers import HEAVY

ROOT = Path(__file__).parents[2]


@pytest.fixture
def bash(brake_cal, monkeypatch):
    """What bash gets for the words of a line, the last of which is not finished."""

    def asked(*words):
        monkeypatch.setenv("_BRAKE_CAL_COMPLETE", "complete_bash")
        monkeypatch.setenv("COMP_WORDS", "\n".join(("brake-cal", *map(str, words))))
        monkeypatch.setenv("COMP_CWORD", str(len(words)))
        ran = brake_cal()
        assert (ran.code, ran.err) == (0, "")
        return ran.out.split()

    return asked


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (("show", "--store", "STORE", ""), ["sedan", "wagon"]),
        (("show", "--store", "STORE", "w"), ["wagon", "wagon@1"]),
        (("release", "--store", "STORE", ""), ["sedan@2", "sedan@1", "wagon@1"]),
        (("diff", "--store", "STORE", "wagon@1", "sedan", "@", ""), ["2", "1"]),
        (("show", "--store", "STORE", "sedan", "@", "2"), ["2"]),
        (("show", "--store", "STORE", "sedan@2"), ["sedan@2"]),
        (("verify", "--store", "STORE", "s"), ["sedan"]),
        (("show", "--store", "nowhere", ""), []),
        (("list", "--state", "re"), ["released", "rejected"]),
    ],
)
def test_tables_of_the_store(bash, two, words, offered):
    # bash gives the `@` and what is behind it as words of their own
    words = [str(two) if word == "STORE" else word for word in words]
    if words[-2:] == ["@", ""]:
        words.pop()
    assert bash("tables", *words) == offered


def test_the_store_of_the_settings(bash, two, tmp_path, monkeypatch):
    (tmp_path / "brake-cal.toml").write_text(f'schema = 1\nstore = "{two.name}"\n')
    (tmp_path / "below").mkdir()
    monkeypatch.chdir(tmp_path / "below")
    assert bash("validate", "w") == ["wagon", "wagon@1"]


def test_names_that_the_program_knows(bash):
    assert bash("effects", "") == list(CATALOGUE)
    assert bash("schema", "") == [*SCHEMAS, *documents()]
    assert bash("manual", "ra") == ["ramp"]
    assert bash("batch", "ch") == ["check"]
    assert bash("tables", "export", "x", "--format", "c") == ["csv", "cdfx", "c-header"]
    assert "--require-signed" in bash("validate", "--req")


@pytest.mark.parametrize(
    ("shell", "says"),
    [
        ("bash", "complete -o default"),
        ("zsh", "#compdef brake-cal"),
        ("fish", "complete --command"),
    ],
)
def test_the_script_of_each_shell(shell, says):
    environment = {**os.environ, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    ran = subprocess.run(
        [sys.executable, "-m", "cli.main", "--show-completion", shell],
        cwd=ROOT, env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert says in ran.stdout


def test_tables_are_offered_without_what_is_heavy(two):
    code = "import sys\nfrom cli.main import main\ntry:\n    main()\nexcept SystemExit:\n"
    code += "    print(*sorted({m.split('.')[0] for m in sys.modules}))"
    environment = {
        **os.environ,
        "_BRAKE_CAL_COMPLETE": "complete_bash",
        "COMP_WORDS": f"brake-cal\ntables\nshow\n--store\n{two}\nw",
        "COMP_CWORD": "5",
    }
    ran = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT, env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    *offered, modules = ran.stdout.splitlines()
    assert offered == ["wagon", "wagon@1"]
    assert not {*HEAVY, "rich"} & set(modules.split())
