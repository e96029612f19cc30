"""What one run does to its output folder, written down before it is done.

    out/.publishing.json    {"schema": 1, "work": ..., "remove": [...], "move": [...]}

`perform` goes on from any step, so a run that was killed can be finished by another process. The
old verdict goes first and the new one comes last: there is never one beside files of another run.
"""

import errno
import json
import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath

from calib.files.bounded import VALIDATION, read_bounded
from calib.files.write import sync, write_whole

INTENT = ".publishing.json"
WORK = ".making-"
"""How the name of a work folder begins."""


@dataclass(frozen=True)
class Intent:
    """Changes of a folder; names are paths within it, with ``/``.

    ``work``: name of the work folder. ``remove``: files of earlier runs. ``move``: files of this
    run, the verdict last.
    """

    work: str
    remove: tuple[str, ...]
    move: tuple[str, ...]


def write_intent(out: Path, intent: Intent) -> None:
    """Write an intent to ``out``; from now on it will be done. Raises OSError."""
    made = out / intent.work / INTENT
    write_whole(made, json.dumps({"schema": 1, **asdict(intent)}).encode())
    os.replace(made, out / INTENT)
    sync(out)


def read_intent(out: Path) -> Intent | None:
    """The intent in ``out``, None if there is none.

    Raises OSError if it cannot be read or is damaged: its names could lead out of the folder.
    """
    try:
        read = json.loads(read_bounded(out / INTENT, VALIDATION))
        intent = Intent(str(read["work"]), tuple(read["remove"]), tuple(read["move"]))
        inside = all(is_inside(name) for name in (intent.work, *intent.remove, *intent.move))
        if read["schema"] == 1 and inside and intent.work.startswith(WORK) and intent.move:
            return intent
    except FileNotFoundError:
        return None
    except (ValueError, KeyError, TypeError, RecursionError):
        pass
    raise OSError(errno.EINVAL, f"{INTENT} in it is damaged; delete it", str(out / INTENT))


def is_inside(name: str) -> bool:
    """Whether a name is a path that stays within a folder."""
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts


def perform(out: Path, intent: Intent) -> None:
    """Do what is left of an intent, from any step on.

    If files of the run are lost, because somebody deleted its work folder, all of it is removed
    instead. Raises OSError.
    """
    work, (*others, verdict) = out / intent.work, intent.move
    if (work / verdict).exists() and all(_either(work, out, name) for name in others):
        _remove(out, [verdict])
        sync(out)
        _remove(out, intent.remove)
        for name in others:
            (out / name).parent.mkdir(parents=True, exist_ok=True)
            if (work / name).exists():
                os.replace(work / name, out / name)
        for folder in {(out / name).parent for name in others}:
            sync(folder)
        os.replace(work / verdict, out / verdict)
    elif (work / verdict).exists() or not (out / verdict).exists():
        _remove(out, [verdict, *intent.remove, *intent.move])
        _remove_empty_folders(out, intent.move)
    sync(out)
    (out / INTENT).unlink()
    sync(out)


def undo(out: Path, intent: Intent) -> None:
    """Remove the files of an intent from ``out`` and forget it; its verdict is deleted first.

    An old verdict that could not be removed stays with its files. Raises OSError; the next start
    then goes on.
    """
    verdict = intent.move[-1]
    made = out / intent.work / verdict
    (made if made.exists() else out / verdict).unlink(missing_ok=True)
    perform(out, intent)


def refuse_obstacles(out: Path, names: Iterable[str]) -> None:
    """Raise OSError if a folder is where a file of ``names`` goes, or a file where its folder."""
    for name in names:
        if (out / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(out / name))
        for folder in _folders(out, name):
            if folder.exists() and not folder.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _either(work: Path, out: Path, name: str) -> bool:
    return (work / name).exists() or (out / name).exists()


def _remove(out: Path, names: Iterable[str]) -> None:
    for name in names:
        if not (out / name).is_dir():
            (out / name).unlink(missing_ok=True)


def _remove_empty_folders(out: Path, names: Iterable[str]) -> None:
    for name in names:
        for folder in _folders(out, name):
            with suppress(OSError):  # missing, or with other files
                folder.rmdir()


def _folders(out: Path, name: str) -> list[Path]:
    """Folders between ``out`` and the file ``name``, the inner ones first."""
    return [out / folder for folder in [*PurePosixPath(name).parents][:-1]]
