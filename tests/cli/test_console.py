"""What is printed: JSON types, no markup, colours, bars, quiet and verbose."""

import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from calib.help.samples import sample_logs
from cli.console import plain, print_error, print_json, print_result

SEDAN = sample_logs() / "sedan"
FIT = ("fit", SEDAN / "ramp_wet_asphalt.csv", "--vehicle", SEDAN / "vehicle.toml")


@dataclass(frozen=True)
class Point:
    name: str
    place: Path
    values: tuple[float, ...]


def test_plain_takes_what_results_are_made_of(capsys):
    document = {
        "point": Point("Über", Path("x/y"), (1.0, float("nan"))),
        "array": np.array([[1.0, np.inf], [2.0, -np.inf]]),
        "scalars": [np.float64(0.5), np.float32(0.25), np.int64(3), np.bool_(True), None],
        7: np.float64("nan"),
    }
    assert plain(document) == {
        "point": {"name": "Über", "place": "x/y", "values": [1.0, None]},
        "array": [[1.0, None], [2.0, None]],
        "scalars": [0.5, 0.25, 3, True, None],
        "7": None,
    }
    print_json(document)
    assert json.loads(capsys.readouterr().out) == plain(document)


def test_nothing_in_a_string_is_markup_and_no_line_is_cut(capsys):
    text = "[bold]log[/bold] :car: [/x] " + "long " * 60 + "to the end"
    print_result(text)
    print_error(text)
    assert capsys.readouterr() == (f"{text}\n", f"error: {text}\n")


def test_quiet_prints_the_verdict_and_verbose_tells_more(brake_cal, tmp_path):
    usual = brake_cal(*FIT, "--store", tmp_path / "a")
    quiet = brake_cal(*FIT, "--store", tmp_path / "b", "-q")
    assert "fitting" in usual.err
    assert "fitting" not in quiet.err
    assert quiet.out == usual.out.splitlines(keepends=True)[0]
    assert "no such file" in brake_cal("check", tmp_path / "none.csv", "-q").err
    assert "brake-cal.toml" in brake_cal("settings").err  # one run does not hush the next
    ran = brake_cal("check", SEDAN / "coast.csv", "-v")
    assert re.search(r"coast\.csv: \d+ samples, .* SHA-256 [0-9a-f]{12}", ran.err)


@pytest.mark.parametrize(
    ("environment", "bar", "colour"),
    [
        ({"TERM": "xterm"}, True, True),
        ({"TERM": "xterm", "NO_COLOR": "1"}, True, False),
        ({"TERM": "dumb"}, False, False),
    ],
)
def test_a_bar_is_drawn_on_a_terminal_that_can_show_one(tmp_path, environment, bar, colour):
    out, screen = on_a_terminal(("check", SEDAN / "coast.csv", "--json"), tmp_path, **environment)
    assert len(json.loads(out)["logs"]) == 1
    assert ("\u2501" in screen) == bar
    assert bool(re.search(r"\x1b\[[\d;]*3[0-9]m", screen)) == colour


def on_a_terminal(words, folder, **variables):
    """Run the command with a terminal for stderr; return stdout, and what the terminal gets."""
    pty = pytest.importorskip("pty")
    environment = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "COLUMNS")}
    environment["PYTHONPATH"] = str(Path(__file__).parents[2])
    ours, theirs = pty.openpty()
    ran = subprocess.Popen(
        [sys.executable, "-m", "cli.main", *map(str, words)],
        cwd=folder,
        env=environment | variables,
        stdout=subprocess.PIPE,
        stderr=theirs,
    )
    os.close(theirs)
    screen = b""
    try:
        while part := os.read(ours, 4096):
            screen += part
    except OSError:  # how Linux says that nobody is left on the other side
        pass
    os.close(ours)
    out, _ = ran.communicate()
    return out.decode(), screen.decode()
