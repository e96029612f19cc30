"""Write files completely or not at all, and all files of a run in a folder together.

    out/.making-<random>/    where a run makes its files; locked while that run is alive

The old verdict goes first and the new one comes last. A run that is killed leaves its folder, which
the next one deletes, and the old run, the new one, or no verdict.
"""

import errno
import fcntl
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath

_WORK = ".making-"
"""How the name of a work folder begins."""


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path`` in one step; it is on the disk when this returns.

    A reader gets the old file or the new one, never a part. The new file is made as
    ``.<name>.new``; one that a killed run left is used again. Raises OSError if the directory
    cannot be written.
    """
    new = path.with_name(f".{path.name}.new")
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
    with os.fdopen(_lock(new, flags), "r+b") as file:
        try:
            file.truncate()
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
            os.replace(new, path)
        except BaseException:
            new.unlink(missing_ok=True)
            raise
    sync(path.parent)


@contextmanager
def locked_folder(folder: Path, wait: bool = True) -> Iterator[None]:
    """Hold the lock of a folder, which is made if it is not there.

    A folder that stays empty and was made here is removed. The lock holds between processes of one
    computer, and between computers where the file system passes `flock` on. Raises BlockingIOError
    if another process has it and ``wait`` is false, OSError.
    """
    made = not folder.exists()
    handle = _lock(folder, os.O_RDONLY, wait)
    try:
        yield
    finally:
        if made:
            with suppress(OSError):
                folder.rmdir()
        os.close(handle)


def _lock(path: Path, flags: int, wait: bool = True) -> int:
    """A handle with the lock of what is at ``path`` now; a folder is made if it is not there."""
    while True:
        if not flags & os.O_CREAT:
            path.mkdir(parents=True, exist_ok=True)
        handle = os.open(path, flags, 0o666)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
            with suppress(FileNotFoundError):  # its last holder renamed or deleted it
                if os.path.samestat(os.fstat(handle), os.stat(path)):
                    return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)


def sync(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """Make a hidden work folder in ``out``; it is deleted afterwards.

    It is inside ``out``, because the parent folder may be on another file system. Those of killed
    runs are deleted. If ``out`` did not exist before and stays empty, it is deleted too. Raises
    OSError at once if ``out`` cannot be written.
    """
    made = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    try:
        for work in out.glob(f"{_WORK}*"):
            with suppress(BlockingIOError, PermissionError), locked_folder(work, wait=False):
                shutil.rmtree(work)
        work = Path(tempfile.mkdtemp(prefix=_WORK, dir=out))
        with locked_folder(work):
            try:
                yield work
            finally:
                shutil.rmtree(work, ignore_errors=True)
    finally:
        if made:
            with suppress(OSError):
                out.rmdir()


def publish(
    work: Path, out: Path, verdict: str, stale: Callable[[Path], Iterable[str]] | None = None
) -> list[Path]:
    """Move everything from ``work``, made by `workshop`, into ``out``; return the paths.

    Parameters
    ----------
    verdict : name of the file in ``work`` that says what the others are; it is moved last.
    stale : gives the names of files of earlier runs in ``out``. Those that this run did not make
        again are removed; other files stay. Called while no other run is published there.

    Where a file cannot be moved, those that were moved are removed; the old verdict is gone then.
    Raises OSError.
    """
    files = (path for path in work.rglob("*") if not path.is_dir())
    names = sorted(path.relative_to(work).as_posix() for path in files)
    names = [*(name for name in names if name != verdict), verdict]
    refuse_obstacles(out, names)
    for path in work.rglob("*"):
        sync(path)
    with locked_folder(out):
        old = {name for name in (stale(out) if stale else ()) if _is_inside(out, name)} - {*names}
        _remove(out, [verdict])
        sync(out)
        _remove(out, old)
        try:
            for name in names:
                if name == verdict:  # when the others are on the disk
                    for parent in {(out / other).parent for other in names}:
                        sync(parent)
                (out / name).parent.mkdir(parents=True, exist_ok=True)
                os.replace(work / name, out / name)
            sync(out)
        except BaseException:
            _remove(out, names)
            raise
    return [out / name for name in names]


def _is_inside(out: Path, name: str) -> bool:
    """Whether a name is a path that stays within the folder ``out``, also where links lead."""
    path = PurePosixPath(name)
    plain = bool(path.parts) and not path.is_absolute() and ".." not in path.parts
    return plain and (out / name).parent.resolve().is_relative_to(out.resolve())


def refuse_obstacles(out: Path, names: Iterable[str]) -> None:
    """Raise OSError if a folder is where a file of ``names`` goes, or a file where its folder."""
    for name in names:
        if (out / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(out / name))
        for folder in _folders(out, name):
            if folder.exists() and not folder.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _remove(out: Path, names: Iterable[str]) -> None:
    """Delete files, and the folders of theirs that are empty then."""
    for name in names:
        if not (out / name).is_dir():
            (out / name).unlink(missing_ok=True)
        for folder in _folders(out, name):
            with suppress(OSError):  # missing, or with other files
                folder.rmdir()


def _folders(out: Path, name: str) -> list[Path]:
    """Folders between ``out`` and the file ``name``, the inner ones first."""
    return [out / folder for folder in [*PurePosixPath(name).parents][:-1]]
