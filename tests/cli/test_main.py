"""A full disk gives 5 and one line on stderr, a reader that went away gives 0 and none."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
COAST = str(ROOT / "sample_logs" / "sedan" / "coast.csv")
WORDS = [
    ["--help"],
    ["effects"],  # drawn by rich
    ["schema", "table"],  # printed, and flushed by the last command only
    ["check", COAST, "--json"],
    ["check", "no-such-log.csv", "--json"],  # the document of an error
]

full = pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full")


def run(words, **streams):
    command = [sys.executable, "-m", "cli.main", *words]
    return subprocess.run(command, cwd=ROOT, check=False, **{"stderr": subprocess.PIPE, **streams})


@full
@pytest.mark.parametrize("words", WORDS, ids=" ".join)
def test_a_full_disk(words):
    with open("/dev/full", "wb") as disk:
        ran = run(words, stdout=disk)
    lines = ran.stderr.decode().splitlines()
    assert ran.returncode == 5
    assert sum("the answer could not be written" in line for line in lines) == 1
    assert not any("Traceback" in line for line in lines)


@pytest.mark.parametrize("words", WORDS[:4], ids=" ".join)
def test_a_reader_that_went_away(words):
    reader, writer = os.pipe()
    os.close(reader)
    ran = run(words, stdout=writer)
    os.close(writer)
    assert (ran.returncode, ran.stderr) == (0, b"")


@full
def test_messages_that_cannot_be_written():
    with open("/dev/full", "wb") as disk:
        ran = run(["check", "-v", COAST], stdout=subprocess.PIPE, stderr=disk)
    assert ran.returncode == 5


def test_streams_that_the_shell_has_closed():
    command = f"{sys.executable} -m cli.main effects"
    for closed, code in ((">&-", 5), ("2>&-", 0)):
        ran = subprocess.run(f"{command} {closed}", shell=True, cwd=ROOT, capture_output=True)
        assert ran.returncode == code


def test_a_bad_file_ends_with_3_and_no_traceback(tmp_path):
    """Nor does the interpreter print a traceback as it ends."""
    path = tmp_path / "empty.csv"
    path.write_text("")
    ran = run(["check", str(path), "--json"], stdout=subprocess.PIPE)
    assert ran.returncode == json.loads(ran.stdout)["error"]["exit_code"] == 3
    assert ran.stderr.decode().splitlines()[-1].startswith(f"error: {path}: ")
    assert b"Traceback" not in ran.stderr
