"""Logs of the command line: files, and one log from stdin that is written as `-`."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.console import Step, say, this_run

if TYPE_CHECKING:
    from calib.logs.channel_map import ChannelMap
    from calib.logs.log import Log

NAMED = Path("stdin.csv")
"""Name of a log from stdin in messages and results; such a log is text."""


def is_stdin(path: Path) -> bool:
    """Whether a log is to be read from stdin; ``./-`` is a file of that name."""
    return str(path) == "-"


def named(paths: Sequence[Path]) -> list[Path]:
    """The paths by which results name the logs."""
    return [NAMED if is_stdin(path) else path for path in paths]


def read_all(
    paths: Sequence[Path], mapping: "ChannelMap | None", step: Step, more: int = 0
) -> "list[Log]":
    """Read logs one by one, with a progress bar that has ``more`` steps after them."""
    runs = []
    for i, path in enumerate(paths):
        step(f"reading {path.name}", i, len(paths) + more)
        runs.append(read(path, mapping))
    return runs


def read(path: Path, mapping: "ChannelMap | None", **needs: Any) -> "Log":
    """Read a log as `calib.logs.read.read_log`, a file or that on stdin, and tell what was read."""
    from calib.logs.read import read_log

    name, data = source_of(path)
    log = read_log(name, mapping, data=data, **needs)
    if this_run().verbose:
        say(
            f"read {log.source}: {log.time.size} samples, {log.time[-1] - log.time[0]:.2f} s, "
            f"{', '.join(log.channels)}; SHA-256 {log.digest[:12]}"
        )
    return log


def source_of(path: Path) -> tuple[Path, bytes | None]:
    """Path of a log, and its bytes if it is on stdin."""
    return (NAMED, _stdin()) if is_stdin(path) else (path, None)


def _stdin() -> bytes:
    """The bytes on stdin. Raises LogError where there are none, or more than a log may have."""
    from calib.base.bounded import LOG
    from calib.base.errors import LogError

    if sys.stdin.isatty():
        raise LogError("stdin is a terminal", where="-", expected="a log", do="cat LOG | ...")
    data = sys.stdin.buffer.read(LOG.most + 1)
    if len(data) > LOG.most:
        raise LogError(f"not readable: {LOG.excess()}", where="-")
    return data
