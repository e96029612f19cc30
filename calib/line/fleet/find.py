"""Find logs by patterns, folders and paths."""

import glob
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from calib.base.errors import LogError
from calib.line.fleet.results import NAME as RESULTS
from calib.line.fleet.rows import Command
from calib.line.fleet.work import CALIBRATION, HOLDOUT, VEHICLE
from calib.logs.read import FORMATS


def find_logs(arguments: Iterable[str], command: Command, out: Path) -> Iterator[str]:
    """Paths of the logs, relative where the argument is; one may come twice.

    A folder means all logs in it and below. For DIAGNOSE a log is a folder with calibration/,
    holdout/ and vehicle.toml. Hidden files and the results in ``out`` are left out; if ``out`` is a
    folder within an argument, so is all its content. Raises LogError for a pattern or folder
    without logs, and for a missing path; a missing file with the ending of a log is returned.
    """
    for argument in arguments:
        path = None
        for path in _of(argument, command, out):
            yield path
        if path is None:
            raise LogError(
                "no log found",
                where=argument,
                expected=f"folders with {CALIBRATION}/, {HOLDOUT}/ and {VEHICLE}"
                if command == Command.DIAGNOSE
                else f"files that end in {', '.join(FORMATS)}",
                do="check the path; put a pattern in quotes",
            )


def _of(argument: str, command: Command, out: Path) -> Iterator[str]:
    if os.path.isdir(argument):
        yield from logs_below(argument, command, out)
    elif os.path.exists(argument) or (_is_log(argument) and not glob.has_magic(argument)):
        yield argument  # a missing file gets a row with an error
    else:
        results = os.path.realpath(out / RESULTS)
        for path in sorted(glob.iglob(argument, recursive=True)):
            if os.path.isdir(path):
                yield from logs_below(path, command, out)
            elif (
                command != Command.DIAGNOSE and _is_log(path) and os.path.realpath(path) != results
            ):
                yield path


def _refuse(error: OSError) -> None:
    raise LogError(f"cannot be read ({error.strerror})", where=error.filename) from error


def logs_below(
    folder: str, command: Command, out: Path, trouble: Callable[[OSError], None] = _refuse
) -> Iterator[str]:
    """Paths of the logs in a folder and below, possibly none. Else like `find_logs`.

    ``trouble`` is called with the error if a folder cannot be read; the folder is then skipped.
    """
    own = os.path.realpath(out)
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


def _is_log(path: str) -> bool:
    name = os.path.basename(path)
    return name.lower().endswith(FORMATS) and not name.startswith(".")
