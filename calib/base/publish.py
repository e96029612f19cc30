"""Files of one run in a folder: all of them or none, whatever is killed when.

    out/.making-<random>/       where a run makes its files
    out/.making-<random>.lock   locked while that run is alive
    out/.publishing/            the files of the run that is published now, and what to remove
    out/.publishing.lock        locked by the one process that changes out

All of these are gone after a run. What a killed run left is settled by the next one: from the
renaming of its work folder on a run is published, and each step of that can be done again.

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
from pathlib import Path, PurePosixPath

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.write import locked, sync, write_whole

PUBLISHING = ".publishing"
INTENT = ".intent.json"
"""In the folder of the run that is published: ``{"schema": 1, "verdict": ..., "remove": [...]}``"""
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
    made, work = not out.exists(), out / f"{_WORK}{secrets.token_hex(8)}"
    out.mkdir(parents=True, exist_ok=True)
    try:
        with ExitStack() as owned:
            with _alone(out):
                _settle(out)
                owned.enter_context(locked(_lock_of(work)))
                owned.callback(_delete, work)
                work.mkdir()
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
    names = sorted(_files(work), key=lambda name: (name == verdict, name))
    with _alone(out):
        _finish(out)
        refuse_obstacles(out, names)
        left = {name for name in stale(out) if _is_inside(name)} - {*names}
        for path in (work, *work.rglob("*")):
            sync(path)
        intent = {"schema": 1, "verdict": verdict, "remove": sorted(left)}
        write_whole(work / INTENT, json.dumps(intent).encode())
        os.replace(work, out / PUBLISHING)
        sync(out)
        try:
            _finish(out)
        except BaseException:
            with suppress(OSError):
                _undo(out, names)
            raise
    return [out / name for name in names]


def settle(out: Path) -> bool:
    """Finish or clear what killed runs left in ``out``; return whether there was anything.

    The work of a run that is alive is not touched. Raises OSError if ``out`` cannot be written.
    """
    if not any((*out.glob(f"{_WORK}*"), *out.glob(f"{PUBLISHING}*"))):
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


def _settle(out: Path) -> bool:
    finished = _finish(out)
    works = {path.name.removesuffix(".lock") for path in out.glob(f"{_WORK}*")}
    cleared = [name for name in sorted(works) if _cleared(out / name)]
    return finished or bool(cleared)


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


def _files(folder: Path) -> list[str]:
    """Paths of all files in a folder, within it, with ``/``."""
    found = (path for path in folder.rglob("*") if not path.is_dir())
    return [name for path in found if (name := path.relative_to(folder).as_posix()) != INTENT]


def _finish(out: Path) -> bool:
    """Publish a run whose work folder was renamed, from any step on; return whether there was one.

    Without its intent it is undone, without its verdict done. Raises OSError.
    """
    folder = out / PUBLISHING
    if not folder.exists():
        return False
    verdict, remove = _read_intent(folder)
    if (folder / verdict).is_file():
        _remove(out, [verdict])
        sync(out)
        _remove(out, remove)
        others = [name for name in _files(folder) if name != verdict]
        for name in others:
            (out / name).parent.mkdir(parents=True, exist_ok=True)
            os.replace(folder / name, out / name)
        for parent in {(out / name).parent for name in others}:
            sync(parent)
        os.replace(folder / verdict, out / verdict)
        sync(out)
    shutil.rmtree(folder)
    sync(out)
    return True


def _read_intent(folder: Path) -> tuple[str, list[str]]:
    """The verdict and the files to remove; no verdict where there is no intent.

    Raises OSError if it cannot be read or is damaged: its names could lead out of the folder.
    """
    try:
        read = json.loads(read_bounded(folder / INTENT, VALIDATION))
        verdict, remove = str(read["verdict"]), list(read["remove"])
        if read["schema"] == 1 and all(map(_is_inside, (verdict, *remove))):
            return verdict, remove
    except FileNotFoundError:
        return "", []
    except (ValueError, KeyError, TypeError, RecursionError):
        pass
    where = str(folder / INTENT)
    raise OSError(errno.EINVAL, f"{INTENT} in it is damaged; delete {PUBLISHING}", where)


def _is_inside(name: str) -> bool:
    """Whether a name is a path that stays within a folder."""
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts


def _undo(out: Path, names: list[str]) -> None:
    """Remove from ``out`` what was moved, the verdict first, and forget the rest."""
    folder = out / PUBLISHING
    moved = [name for name in reversed(names) if not (folder / name).exists()]
    (folder / INTENT).unlink()
    _remove(out, moved)
    for name in moved:
        for parent in _folders(out, name):
            with suppress(OSError):  # missing, or with other files
                parent.rmdir()
    shutil.rmtree(folder)
    sync(out)


def refuse_obstacles(out: Path, names: Iterable[str]) -> None:
    """Raise OSError if a folder is where a file of ``names`` goes, or a file where its folder."""
    for name in names:
        if (out / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(out / name))
        for folder in _folders(out, name):
            if folder.exists() and not folder.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _remove(out: Path, names: Iterable[str]) -> None:
    for name in names:
        if not (out / name).is_dir():
            (out / name).unlink(missing_ok=True)


def _folders(out: Path, name: str) -> list[Path]:
    """Folders between ``out`` and the file ``name``, the inner ones first."""
    return [out / folder for folder in [*PurePosixPath(name).parents][:-1]]
