"""Read the logs of the command line."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.console import Step, say, this_run

if TYPE_CHECKING:
    from calib.logs.channel_map import ChannelMap
    from calib.logs.log import Log


def read_all(
    paths: Sequence[Path], channel_map: "ChannelMap | None", step: Step, more: int = 0
) -> "list[Log]":
    """Read logs, and show the progress of a task that has ``more`` steps after them."""
    runs = []
    for i, path in enumerate(paths):
        step(f"reading {path.name}", i, len(paths) + more)
        runs.append(read(path, channel_map))
    return runs


def read(path: Path, channel_map: "ChannelMap | None", **needs: Any) -> "Log":
    """Read a log as `calib.logs.read.read_log` does with ``needs``; -v prints what was read."""
    from calib.logs.read import read_log

    log = read_log(path, channel_map, **needs)
    if this_run().verbose:
        say(
            f"read {log.source}: {log.time.size} samples, {log.time[-1] - log.time[0]:.2f} s, "
            f"{', '.join(log.channels)}; SHA-256 {log.digest[:12]}"
        )
    return log
