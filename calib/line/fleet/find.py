"""Find logs by patterns, folders and paths, one at a time, to save memory."""

import glob
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from calib.base.errors import LogError
from calib.line.fleet.command import Command
from calib.line.fleet.results import NAME as RESULTS
from calib.line.fleet.work import CALIBRATION, HOLDOUT, VEHICLE
from calib.logs.read import FORMATS


def find_logs(arguments: Iterable[str], command: Command, out: Path) -> Iterator[str]:
    """Paths of the logs, relative where the argument is; one may come twice.

    A folder means all logs in it and below. For DIAGNOSE a log is a folder with calibration/,
    holdout/ and vehicle.toml. Hidden files and the results in ``out`` are left out; if ``out`` is a
    folder within an argument, so is all its content. Raises LogError for a pattern or folder
    without logs, and for a missing path; a missing file with the ending of a log is returned.
    """
    own = os.path.realpath(out)
    for argument in arguments:
        found = False
        for path in _of(argument, command, own):
            found = True
            yield path
        if not found:
            raise LogError(
                "no log found",
                where=argument,
                expected=_expected(command),
                do="check the path; put a pattern in quotes",
            )


def logs_below(
    folder: str, command: Command, out: Path, trouble: Callable[[OSError], None]
) -> Iterator[str]:
    """Paths of the logs in a folder and below, possibly none. Else like `find_logs`.

    ``trouble`` is called with the error if a folder cannot be read; the folder is then skipped.
    """
    return _below(folder, command, os.path.realpath(out), trouble)


def _expected(command: Command) -> str:
    if command == Command.DIAGNOSE:
        return f"folders with {CALIBRATION}/, {HOLDOUT}/ and {VEHICLE}"
    return f"files that end in {', '.join(FORMATS)}"


def _of(argument: str, command: Command, own: str) -> Iterator[str]:
    if os.path.isdir(argument):
        yield from _below(argument, command, own)
    elif os.path.exists(argument) or (_is_log(argument) and not glob.has_magic(argument)):
        yield argument  # a missing file gets a row with an error
    else:
        for path in sorted(glob.iglob(argument, recursive=True)):
            if os.path.isdir(path):
                yield from _below(path, command, own)
            elif command != Command.DIAGNOSE and _is_log(path) and not _is_result(path, own):
                yield path


def _refuse(error: OSError) -> None:
    raise LogError(f"cannot be read ({error.strerror})", where=error.filename) from error


def _below(
    folder: str, command: Command, own: str, trouble: Callable[[OSError], None] = _refuse
) -> Iterator[str]:
    for home, folders, files in os.walk(folder, onerror=trouble):
        folders[:] = sorted(f for f in folders if not f.startswith("."))
        here = os.path.realpath(home) == own
        if here and home != folder:
            folders.clear()
        elif command == Command.DIAGNOSE:
            if VEHICLE in files and {CALIBRATION, HOLDOUT} <= set(folders):
                folders.clear()
                yield home
        else:
            logs = (f for f in sorted(files) if _is_log(f) and not (here and f == RESULTS))
            yield from (os.path.join(home, f) for f in logs)


def _is_result(path: str, own: str) -> bool:
    return os.path.realpath(path) == os.path.join(own, RESULTS)


def _is_log(path: str) -> bool:
    name = os.path.basename(path)
    return name.lower().endswith(FORMATS) and not name.startswith(".")
