"""Write files completely or not at all, and all files of a run in a folder together.

    out/.lock                    is locked while a run is published or a store changed
    out/.making-<random>.lock    is locked while a run makes its files
    out/.making-<random>/        where it makes them

The old verdict is removed first and the new one written last. A killed run leaves the old run, the
new one, or no verdict, and a folder that the next run deletes. No file is replaced or removed while
it is open or locked, which Windows forbids.
"""

import errno
import os
import secrets
import shutil
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath

_LOCK = ".lock"  # of a folder, and how the lock file of a work folder ends
_WORK = ".making-"
_RETRIES = (0.02, 0.1, 0.5, 2.0)  # waits for a file that a reader or scanner holds on Windows [s]


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path`` atomically, and to the disk. Raises OSError.

    The new file is made beside it, as ``.<name>.<random>.new``.
    """
    new = path.with_name(f".{path.name}.{secrets.token_hex(4)}.new")
    try:
        with new.open("xb") as file:
            file.write(content)
            file.flush()
            _flush(file.fileno())
        _replace(new, path)
    except BaseException:
        new.unlink(missing_ok=True)
        raise
    sync(path.parent)


def _replace(source: Path, target: Path) -> None:
    waits = [*_RETRIES] if sys.platform == "win32" else []
    while True:
        try:
            os.replace(source, target)
            break
        except PermissionError:
            if not waits:
                raise
            time.sleep(waits.pop(0))


@contextmanager
def locked_folder(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, which is made if missing, and removed if it then stays empty.

    It holds between computers if the file system supports that. Raises OSError.
    """
    is_new = not folder.exists()
    try:
        with _locked(folder / _LOCK):
            yield
    finally:
        if is_new:
            with suppress(OSError):
                folder.rmdir()


@contextmanager
def _locked(path: Path, wait: bool = True) -> Iterator[None]:
    """Hold the lock file ``path``, which is removed afterwards; its folder is made.

    Raises BlockingIOError if another process holds it and ``wait`` is false, OSError.
    """
    from filelock import FileLock, Timeout, UnixFileLock

    handles = list[int]()
    if removes := issubclass(FileLock, UnixFileLock):  # the other kind removes its file itself
        lock = FileLock(path, mode=0o666, preserve_lock_file=True, on_acquired=handles.append)
    else:
        lock = FileLock(path)
    while not lock.is_locked:
        path.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):  # its last holder removed the empty folder
            try:
                lock.acquire(blocking=wait)
            except Timeout as cause:
                raise BlockingIOError(errno.EAGAIN, "locked", str(path)) from cause
            if removes and not _is_open_at(path, handles[-1]):
                lock.release()
    try:
        yield
    finally:
        if removes:
            path.unlink(missing_ok=True)
        lock.release()


def _is_open_at(path: Path, handle: int) -> bool:
    """Whether a handle is of the file that is at ``path`` now, not of one that was removed.

    ``path`` is opened anew, since a network file system may have a removed file in its cache.
    """
    with suppress(FileNotFoundError), path.open("rb") as now:
        return os.path.samestat(os.fstat(now.fileno()), os.fstat(handle))
    return False


def sync(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk; Windows has no such folders."""
    if sys.platform == "win32" and path.is_dir():
        return
    handle = os.open(path, os.O_RDWR if sys.platform == "win32" else os.O_RDONLY)
    try:
        _flush(handle)
    finally:
        os.close(handle)


def _flush(handle: int) -> None:
    """Flush a file to the disk; macOS would leave it in the cache of the disk."""
    if sys.platform == "darwin":
        import fcntl

        with suppress(OSError):  # a file system of another kind
            fcntl.fcntl(handle, fcntl.F_FULLFSYNC)
            return
    os.fsync(handle)


@contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """Make a hidden work folder in ``out``, on the same file system; it is deleted afterwards.

    Those of killed runs are deleted, and a new ``out`` that stays empty. Raises OSError at once if
    ``out`` cannot be written.
    """
    is_new = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    try:
        for name in {path.name.removesuffix(_LOCK) for path in out.glob(f"{_WORK}*")}:
            with (
                suppress(BlockingIOError, PermissionError),
                _locked(out / f"{name}{_LOCK}", wait=False),
            ):
                shutil.rmtree(out / name, ignore_errors=True)
        work = out / f"{_WORK}{secrets.token_hex(4)}"
        with _locked(work.with_name(f"{work.name}{_LOCK}")):
            work.mkdir(0o700)
            try:
                yield work
            finally:
                shutil.rmtree(work, ignore_errors=True)
    finally:
        if is_new:
            with suppress(OSError):
                out.rmdir()


def publish(
    work: Path, out: Path, verdict: str, stale: Callable[[Path], Iterable[str]] | None = None
) -> list[Path]:
    """Move everything from ``work``, made by `workshop`, into ``out``; return the paths.

    The file ``verdict`` is moved last. ``stale``, called under the lock of ``out``, names files of
    earlier runs; those that this run did not make again are removed. If a file cannot be moved, all
    new ones and the old verdict are removed. Raises OSError.
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
                _replace(work / name, out / name)
            sync(out)
        except BaseException:
            _remove(out, names)
            raise
    return [out / name for name in names]


def _is_inside(out: Path, name: str) -> bool:
    """Whether a path stays within the folder ``out``, also through links."""
    path = PurePosixPath(name)
    plain = bool(path.parts) and not path.is_absolute() and ".." not in path.parts
    return plain and (out / name).parent.resolve().is_relative_to(out.resolve())


def refuse_obstacles(out: Path, names: Iterable[str]) -> None:
    """Raise OSError for a folder in the place of a file of ``names``, or a file for its folder."""
    for name in names:
        if (out / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(out / name))
        for folder in _folders(out, name):
            if folder.exists() and not folder.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _remove(out: Path, names: Iterable[str]) -> None:
    """Delete files, and their folders that are empty then."""
    for name in names:
        if not (out / name).is_dir():
            (out / name).unlink(missing_ok=True)
        for folder in _folders(out, name):
            with suppress(OSError):  # missing, or with other files
                folder.rmdir()


def _folders(out: Path, name: str) -> list[Path]:
    """Folders between ``out`` and the file ``name``, the inner ones first."""
    return [out / folder for folder in [*PurePosixPath(name).parents][:-1]]
