"""A command as a terminal shows it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


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
    seen = b""
    try:
        while part := os.read(ours, 4096):
            seen += part
    except OSError:  # how Linux says that nobody is left on the other side
        pass
    os.close(ours)
    out, _ = ran.communicate()
    return out.decode(), seen.decode()
