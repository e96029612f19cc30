"""Files of one run in a folder: all of them or none, whatever is killed when.

    out/.making-<random>/       where a run makes its files
    out/.making-<random>.lock   locked while that run is alive
    out/.publishing.json        what the run that is published now does to out
    out/.publishing.lock        locked by the one process that changes out

All of these are gone after a run. What a killed run left is settled by the next one: the changes of
out are written down before they are done, and each step can be done again.

    {"schema": 1, "work": ..., "remove": [...], "move": [...]}

The old verdict goes first and the new one comes last: there is never one beside files of another
run.
"""

import errno
import json
import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.write import locked, sync, write_whole

INTENT = ".publishing.json"
_WORK = ".making-"
"""How the name of a work folder begins."""
_LOCK = ".publishing.lock"


def _nothing(out: Path) -> Iterable[str]:
    return ()


@contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """Make a hidden work folder in ``out``; it is deleted afterwards.

    It is inside ``out``, because the parent folder may be on another file system. What a killed run
    left is settled first. If ``out`` did not exist before and stays empty, it is deleted too.
    Raises OSError at once if ``out`` cannot be written.
    """
    made = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with _work_folder(out) as work:
            yield work
    finally:
        if made:
            with suppress(OSError):
                out.rmdir()


def publish(
    work: Path, out: Path, verdict: str, stale: Callable[[Path], Iterable[str]] = _nothing
) -> list[Path]:
    """Move everything from ``work``, made by `workshop`, into ``out``; return the paths.

    Parameters
    ----------
    verdict : name of the file in ``work`` that says what the others are; it is moved last.
    stale : gives the names of files of earlier runs in ``out``. Those that this run did not make
        again are removed; other files stay. Called while no other process can change ``out``.

    Where a file cannot be moved, those that were moved are removed; the old verdict is gone then.
    Raises OSError.
    """
    found = (path.relative_to(work).as_posix() for path in work.rglob("*") if not path.is_dir())
    names = tuple(sorted(found, key=lambda name: (name == verdict, name)))
    with _alone(out):
        _finish(out)
        refuse_obstacles(out, names)
        left = {name for name in stale(out) if _is_inside(name)} - {*names}
        intent = _Intent(work.name, tuple(sorted(left)), names)
        _sync_all(work)
        _write_intent(out, intent)
        try:
            _perform(out, intent)
        except BaseException:
            with suppress(OSError):
                _undo(out, intent)
            raise
    return [out / name for name in names]


def settle(out: Path) -> bool:
    """Finish or clear what killed runs left in ``out``; return whether there was anything.

    The work of a run that is alive is not touched. Raises OSError if ``out`` cannot be written.
    """
    if not any((*out.glob(f"{_WORK}*"), *out.glob(".publishing.*"))):
        return False
    with _alone(out):
        return _settle(out)


@contextmanager
def _alone(out: Path) -> Iterator[None]:
    """No other process changes ``out`` within this context."""
    with locked(out / _LOCK):
        try:
            yield
        finally:
            (out / _LOCK).unlink(missing_ok=True)


@contextmanager
def _work_folder(out: Path) -> Iterator[Path]:
    """A new work folder, locked as long as this process has it."""
    work = out / f"{_WORK}{secrets.token_hex(8)}"
    with ExitStack() as owned:
        with _alone(out):
            _settle(out)
            owned.enter_context(locked(_lock_of(work)))
            try:
                work.mkdir()
            except BaseException:
                _lock_of(work).unlink()
                raise
        try:
            yield work
        finally:
            _delete(work)


def _settle(out: Path) -> bool:
    finished = _finish(out)
    works = {path.name.removesuffix(".lock") for path in out.glob(f"{_WORK}*")}
    cleared = [name for name in sorted(works) if _cleared(out / name)]
    return finished or bool(cleared)


def _finish(out: Path) -> bool:
    """Do what a killed run intended; return whether there was an intent."""
    intent = _read_intent(out)
    if intent is not None:
        _perform(out, intent)
    return intent is not None


def _cleared(work: Path) -> bool:
    """Delete a work folder unless its run is alive or another person's; whether it was deleted."""
    try:
        with locked(_lock_of(work), wait=False):
            _delete(work)
    except (BlockingIOError, PermissionError):
        return False
    return True


def _delete(work: Path) -> None:
    shutil.rmtree(work, ignore_errors=True)
    _lock_of(work).unlink(missing_ok=True)


def _lock_of(work: Path) -> Path:
    return work.with_name(f"{work.name}.lock")


def _sync_all(work: Path) -> None:
    """Wait until all files below ``work``, and their names, are on the disk."""
    for path in (work, *work.rglob("*")):
        sync(path)


@dataclass(frozen=True)
class _Intent:
    """Changes of a folder; names are paths within it, with ``/``.

    ``work``: name of the work folder. ``remove``: files of earlier runs. ``move``: files of this
    run, the verdict last.
    """

    work: str
    remove: tuple[str, ...]
    move: tuple[str, ...]


def _write_intent(out: Path, intent: _Intent) -> None:
    """Write an intent to ``out``; from now on it will be done. Raises OSError."""
    made = out / intent.work / INTENT
    write_whole(made, json.dumps({"schema": 1, **asdict(intent)}).encode())
    os.replace(made, out / INTENT)
    sync(out)


def _read_intent(out: Path) -> _Intent | None:
    """The intent in ``out``, None if there is none.

    Raises OSError if it cannot be read or is damaged: its names could lead out of the folder.
    """
    try:
        read = json.loads(read_bounded(out / INTENT, VALIDATION))
        intent = _Intent(str(read["work"]), tuple(read["remove"]), tuple(read["move"]))
        inside = all(_is_inside(name) for name in (intent.work, *intent.remove, *intent.move))
        if read["schema"] == 1 and inside and intent.work.startswith(_WORK) and intent.move:
            return intent
    except FileNotFoundError:
        return None
    except (ValueError, KeyError, TypeError, RecursionError):
        pass
    raise OSError(errno.EINVAL, f"{INTENT} in it is damaged; delete it", str(out / INTENT))


def _is_inside(name: str) -> bool:
    """Whether a name is a path that stays within a folder."""
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts


def _perform(out: Path, intent: _Intent) -> None:
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


def _undo(out: Path, intent: _Intent) -> None:
    """Remove the files of an intent from ``out`` and forget it; its verdict is deleted first.

    An old verdict that could not be removed stays with its files. Raises OSError; the next start
    then goes on.
    """
    verdict = intent.move[-1]
    made = out / intent.work / verdict
    (made if made.exists() else out / verdict).unlink(missing_ok=True)
    _perform(out, intent)


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
