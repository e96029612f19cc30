"""Rows of the table "Where a change goes" of CONTRIBUTING.md, made on a copy of the program."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
RAMP = ROOT / "sample_logs" / "sedan" / "ramp_wet_asphalt.csv"


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy with an effect, an export, a rule, a command and a page of the manual more."""
    folder = tmp_path_factory.mktemp("copy")
    without = shutil.ignore_patterns("__pycache__")
    for package in ("calib", "cli"):
        shutil.copytree(ROOT / package, folder / package, ignore=without)
    for path, old, new in CHANGES:
        text = (folder / path).read_text() if old else ""
        assert text.count(old) == 1 or not old
        (folder / path).write_text(text.replace(old, new) if old else new)
    for path, row in ROWS.items():
        with (folder / path).open("a") as table:
            table.write(row)
    return folder


CHANGES = (
    (
        "calib/car/effects/pads.py",
        "EFFECTS = (\n",
        "def _halved(parameters, history, p_f, p_r):\n"
        '    share = 1.0 - parameters["loss"] + 0.0 * p_f\n    return share, share\n\n\n'
        'EFFECTS = (\n    effect("pads_of_chalk", friction=_halved),\n',
    ),
    ("calib/exports/templates/names.j2", "", "{{ data.stored.id }}\n"),
    (
        "calib/exports/write.py",
        "FORMATS = {\n",
        'FORMATS = {\n    "names": _Format("txt", partial(_filled, "names", printable)),\n',
    ),
    (
        "calib/plausibility/driving.py",
        "def driving(",
        "def length_of_log(evidence: Evidence) -> Iterator[Measured]:\n"
        "    time = evidence.run.log.time\n"
        '    yield Measured("log_length", float(time[-1] - time[0]))\n\n\n'
        "def driving(",
    ),
    (
        "calib/plausibility/rules.py",
        "    driving.clock,",
        "    driving.clock, driving.length_of_log,",
    ),
    (
        "cli/hello.py",
        "",
        "from cli.command import Answer, command\n\n\n"
        '@command("brake-cal hello")\ndef hello() -> Answer:\n    """Greet."""\n'
        '    return Answer({"greeting": "hello"}, "hello")\n',
    ),
    ("cli/main.py", '    "Help": {\n', '    "Help": {\n        "hello:hello": "Greet",\n'),
    ("calib/manual/chalk.md", "", "# Chalk\n\nPads of chalk.\n"),
    (
        "calib/manual/index.md",
        "## Begin\n\n",
        "## Begin\n\n- [Chalk](chalk.md): pads of chalk.\n",
    ),
)
"""Path, a text that stands there once or "" for a new file, and what takes its place."""

ROWS = {
    "calib/car/effects/cards.csv": "pads_of_chalk,0,chalk,mu (1 - loss),none,weak brakes,\n",
    "calib/car/effects/parameters.csv": "pads_of_chalk,loss,1,0,1,0.5,0.2,,\n",
    "calib/base/rules.csv": "log_length,the log is short,length_of_log,s,check,warn,,1e6,,,,,"
    "record for eleven days,,a test\n",
}


def run(copy, *arguments):
    """The JSON document of a command of the copy."""
    line = [sys.executable, "-m", "cli.main", *map(str, arguments), "--json"]
    done = subprocess.run(line, cwd=copy, capture_output=True, text=True, timeout=60, check=True)
    return json.loads(done.stdout)


def test_an_effect_is_two_rows_and_a_function(copy):
    assert "pads_of_chalk" in json.dumps(run(copy, "effects"))


def test_an_export_is_a_template_and_a_line(copy, tmp_path):
    out = tmp_path / "names.txt"
    stored = ROOT / "tables"
    run(copy, "tables", "export", "escort", "--format", "names", "--out", out, "--store", stored)
    assert out.read_text() == "escort@1\n"


def test_a_rule_is_a_row_and_a_function_of_its_figure(copy):
    (log,) = run(copy, "check", RAMP)["logs"]
    (warning,) = [w for w in log["warnings"] if w["code"] == "log_length"]
    time = np.loadtxt(RAMP, delimiter=",", skiprows=1, usecols=0)
    assert warning["measured"] == pytest.approx(np.ptp(time))


def test_a_command_is_a_file_and_a_line(copy):
    assert run(copy, "hello")["greeting"] == "hello"


def test_a_page_is_a_file_and_a_line(copy):
    assert run(copy, "manual", "chalk")["text"].startswith("# Chalk")
