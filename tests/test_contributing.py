"""Rows of the table "Where a change goes" of CONTRIBUTING.md, made on a copy of the program.

The last row of the table, a page of results, changes nothing that can be run.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.support.programs import needs

ROOT = Path(__file__).parents[1]
RAMP = ROOT / "sample_logs" / "sedan" / "ramp_wet_asphalt.csv"
STUDY = ROOT / "sample_logs" / "simulation_study"
COPIED = ("calib", "cli", "sample_logs", "tables", "tests", "pyproject.toml")


def copied(folder):
    """Copy the program into a folder, and return the folder."""
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(
                ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__")
            )
        else:
            shutil.copy(ROOT / name, folder / name)
    return folder


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy of the program with `CHANGES` and `ROWS`."""
    folder = copied(tmp_path_factory.mktemp("copy"))
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
    (
        "calib/car/beliefs.py",
        "    pad_level: Belief\n",
        "    pad_level: Belief\n    chalk: Belief\n",
    ),
    (
        "calib/estimation/constants.py",
        "    most_radii: float",
        "    chalk: float = 0.75  # share of chalk [1]\n    most_radii: float",
    ),
    (
        "calib/estimation/equations.py",
        "def update_zero(",
        "def chalked(x: float) -> float:\n"
        '    """Return x, or half of x where it is small."""\n'
        "    if x < 0.5:\n        return 0.5 * x\n    return x\n\n\n"
        "def update_zero(",
    ),
    (
        "calib/estimation/equations.py",
        "    gain = zero.variance / (zero.variance + variance)\n",
        "    gain = chalked(zero.variance / (zero.variance + variance))\n",
    ),
    ("calib/exports/templates/names.j2", "", "{{ data.stored.id }}\n"),
    (
        "calib/exports/write.py",
        "FORMATS = {\n",
        'FORMATS = {\n    "names": _Format("txt", partial(_filled, "names", printable)),\n',
    ),
    (
        "calib/estimation/metrics.py",
        "    figures: dict[str, Any] = {\n",
        '    figures: dict[str, Any] = {\n        "chalk_share": 0.25,\n',
    ),
    (
        "calib/run/run.py",
        "    @cached_property\n    def missing(",
        "    @cached_property\n    def chalk(self) -> int:\n        return self.log.time.size\n\n"
        "    @cached_property\n    def missing(",
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
        "calib/show/chalk.py",
        "",
        "from calib.show.facts import Facts\n\n\n"
        'def chalk_facts(chalk):\n    return Facts(title="Chalk", headline=f"{chalk.grams} g")\n',
    ),
    (
        "calib/show/facts.py",
        "_FACTS = {\n",
        '_FACTS = {\n    "Chalk": "chalk:chalk_facts",\n',
    ),
    (
        "cli/hello.py",
        "",
        "from typing import NamedTuple\n\nfrom cli.command import Answer, command\n\n\n"
        "class Chalk(NamedTuple):\n    grams: int\n\n\n"
        '@command("brake-cal hello")\ndef hello() -> Answer:\n    """Greet."""\n'
        '    return Answer({"greeting": "hello"}, Chalk(7))\n',
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
    "calib/car/beliefs.csv": "chalk,car,,1,0.5,0.1,1,,,a test\n"
    "log_tyre,stop,chalk,0.01,0,0.1,1,,,a test\n",
    "calib/base/metrics.csv": "chalk_share,stop,Chalk,%,100,0.001,,99,,,,,,,0.5,,,share,a test,\n",
    "calib/base/rules.csv": "log_length,the log is short,length_of_log,s,check,warn,,1e6,,,,,"
    "record for eleven days,,a test\n",
    "calib/help/documents.toml": '\n[hello-json]\ntitle = "brake-cal hello --json"\n'
    '[hello-json.keys]\ngreeting = "text: a word"\n',
}


def started(copy, *arguments):
    """Run Python on the copy, and return what it prints; a process that it starts has the copy."""
    line = [sys.executable, *map(str, arguments)]
    env = {**os.environ, "PYTHONPATH": str(copy)}
    process = subprocess.run(line, cwd=copy, env=env, capture_output=True, text=True, check=False)
    assert process.returncode == 0, process.stderr
    return process.stdout


def run(copy, *arguments):
    """The JSON document of a command of the copy."""
    return json.loads(started(copy, "-m", "cli.main", *arguments, "--json"))


def test_an_effect_is_two_rows_and_a_function(copy):
    assert "pads_of_chalk" in json.dumps(run(copy, "effects"))


def test_a_prior_is_a_row_and_its_field_and_a_case_is_a_row(copy):
    code = "from calib.car.beliefs import CAR, STOP; print(CAR.chalk.mean, STOP.log_tyre.cases)"
    assert started(copy, "-c", code).split() == ["0.5", "('axle',", "'chalk')"]


def test_a_constant_is_a_field_and_stands_in_the_list_of_the_manual(copy):
    code = "from tests.support.theory import constants; print(constants())"
    assert "chalk           0.75" in started(copy, "-c", code)


@needs("cc")
def test_an_equation_is_a_function_of_numbers_which_c_has_as_well(copy):
    test = "test_c_equals_python_while_sensors_fail_at_random"
    started(copy, "-m", "pytest", "-q", "-n0", f"tests/ecu/test_online.py::{test}[0]")


def test_an_export_is_a_template_and_a_line(copy, tmp_path):
    out = tmp_path / "names.txt"
    run(copy, "tables", "export", "escort", "--format", "names", "--out", out)
    assert out.read_text() == "escort@1\n"


def test_a_metric_is_a_row_and_a_number_that_its_limit_judges(copy):
    (stop,) = run(copy, "validate", "sedan-sim", STUDY / "stop_noisy.parquet")["logs"]
    assert stop["figures"]["chalk_share"] == 0.25
    assert [x["figure"] for x in stop["limits"] if x["warned"]] == ["chalk_share"]


def test_a_view_of_a_log_is_a_property_of_its_run(copy):
    imports = "from calib import read_log; from calib.run.run import Run"
    code = f"{imports}; print(Run(read_log({str(RAMP)!r})).chalk)"
    assert int(started(copy, "-c", code)) == len(np.loadtxt(RAMP, delimiter=",", skiprows=1))


def test_a_rule_is_a_row_and_a_function_of_its_figure(copy):
    (log,) = run(copy, "check", RAMP)["logs"]
    (warning,) = [w for w in log["warnings"] if w["code"] == "log_length"]
    time = np.loadtxt(RAMP, delimiter=",", skiprows=1, usecols=0)
    assert warning["measured"] == pytest.approx(np.ptp(time))


def test_a_command_is_a_file_and_a_line(copy):
    assert run(copy, "hello")["greeting"] == "hello"


def test_a_result_is_a_function_of_its_facts_and_a_line(copy):
    assert started(copy, "-m", "cli.main", "hello").split() == ["7", "g"]


def test_a_key_of_a_document_is_a_line_of_its_schema(copy):
    assert "greeting" in run(copy, "schema", "hello-json")["properties"]


def test_a_page_is_a_file_and_a_line(copy):
    assert run(copy, "manual", "chalk")["text"].startswith("# Chalk")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "path"),
    [
        ("sample_store", "tables/journal.jsonl"),
        ("theory", "sample_logs/figures/theory/law.png"),
        ("gallery", "calib/manual/gallery.md"),
    ],
)
def test_other_numbers_are_written_by_a_module(module, path, tmp_path):
    folder = copied(tmp_path)
    written = (folder / path).stat().st_mtime_ns
    started(folder, "-m", f"tests.support.{module}")
    assert (folder / path).stat().st_mtime_ns > written
