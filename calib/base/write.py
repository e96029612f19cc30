"""Write a file completely or not at all, and all files of a run into a folder together.

    out/.making-<random>/        here a run makes its files: `work_folder`
    out/.making-<random>.lock    is locked meanwhile
    out/                         here `publish` moves them, the verdict last
    out/.lock                    is locked meanwhile, and while a store is changed

The verdict is the file by which people see whether a run is complete, such as `summary.json`. The
old verdict is removed first and the new verdict moved last. So a killed run leaves the old run, the
new run, or no verdict; the next run deletes the work folder. No file is replaced or removed while
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

_LOCK = ".lock"  # lock file of a folder, and end of the name of a work folder's lock file
_WORK = ".making-"  # begins the name of a work folder
_WAITS = (0.02, 0.1, 0.5, 2.0)  # for a file that a reader or scanner has open on Windows [s]


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path`` atomically, and flush it to the disk. Raises OSError."""
    new_path = path.with_name(f".{path.name}.{secrets.token_hex(4)}.new")
    try:
        with new_path.open("xb") as file:
            file.write(content)
            file.flush()
            _flush(file.fileno())
        _replace(new_path, path)
    except BaseException:
        new_path.unlink(missing_ok=True)
        raise
    sync(path.parent)


def _replace(source: Path, target: Path) -> None:
    """Rename a file over another file; on Windows, wait for a reader that has it open."""
    for wait in _WAITS if sys.platform == "win32" else ():
        try:
            os.replace(source, target)
            return
        except PermissionError:
            time.sleep(wait)
    os.replace(source, target)


@contextmanager
def locked_folder(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder within the context. Raises OSError.

    A missing folder is made, and removed if it is empty at the end. The lock holds between
    computers if the file system supports that.
    """
    with _removed_if_new_and_empty(folder), _locked(folder / _LOCK):
        yield


@contextmanager
def _removed_if_new_and_empty(folder: Path) -> Iterator[None]:
    is_new = not folder.exists()
    try:
        yield
    finally:
        if is_new:
            with suppress(OSError):  # the folder is missing, or holds files
                folder.rmdir()


@contextmanager
def _locked(path: Path, wait: bool = True) -> Iterator[None]:
    """Make a lock file and its folder, hold the lock within the context, and remove the file.

    Raises BlockingIOError if another process holds the lock and ``wait`` is false, else OSError.
    """
    from filelock import FileLock, Timeout, UnixFileLock

    handles = list[int]()
    is_unix = issubclass(FileLock, UnixFileLock)
    if is_unix:  # this kind leaves the file in place, so it is removed below
        lock = FileLock(path, mode=0o666, preserve_lock_file=True, on_acquired=handles.append)
    else:
        lock = FileLock(path)
    while not lock.is_locked:
        path.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):  # the last holder has just removed the empty folder
            try:
                lock.acquire(blocking=wait)
            except Timeout as cause:
                raise BlockingIOError(errno.EAGAIN, "locked", str(path)) from cause
            if is_unix and not _is_open_at(path, handles[-1]):
                lock.release()  # the last holder has removed this file: lock the next one
    try:
        yield
    finally:
        if is_unix:
            path.unlink(missing_ok=True)
        lock.release()


def _is_open_at(path: Path, handle: int) -> bool:
    """Whether an open file is the file at ``path``, and not a file that was removed there.

    ``path`` is opened anew, since a network file system may have a removed file in its cache.
    """
    with suppress(FileNotFoundError), path.open("rb") as present:
        return os.path.samestat(os.fstat(present.fileno()), os.fstat(handle))
    return False


def sync(path: Path) -> None:
    """Wait until a file, or the list of files in a folder, is on the disk."""
    if sys.platform == "win32" and path.is_dir():  # Windows cannot do this for a folder
        return
    handle = os.open(path, os.O_RDWR if sys.platform == "win32" else os.O_RDONLY)
    try:
        _flush(handle)
    finally:
        os.close(handle)


def _flush(handle: int) -> None:
    """Flush a file to the disk. On macOS fsync alone would leave it in the cache of the disk."""
    if sys.platform == "darwin":
        import fcntl

        with suppress(OSError):  # the file system does not support it
            fcntl.fcntl(handle, fcntl.F_FULLFSYNC)
            return
    os.fsync(handle)


@contextmanager
def work_folder(out: Path) -> Iterator[Path]:
    """Make a hidden work folder in ``out``, so on the same file system; delete it afterwards.

    Work folders of killed runs are deleted, too. A missing ``out`` is made, and removed if it stays
    empty. Raises OSError at once if ``out`` cannot be written.
    """
    with _removed_if_new_and_empty(out):
        out.mkdir(parents=True, exist_ok=True)
        _delete_abandoned(out)
        work = out / f"{_WORK}{secrets.token_hex(4)}"
        with _locked(work.with_name(f"{work.name}{_LOCK}")):
            work.mkdir(0o700)
            try:
                yield work
            finally:
                shutil.rmtree(work, ignore_errors=True)


def _delete_abandoned(out: Path) -> None:
    """Delete the work folders of runs that no longer hold their lock."""
    for name in {path.name.removesuffix(_LOCK) for path in out.glob(f"{_WORK}*")}:
        with (
            suppress(BlockingIOError, PermissionError),  # the run is alive, or of another user
            _locked(out / f"{name}{_LOCK}", wait=False),
        ):
            shutil.rmtree(out / name, ignore_errors=True)


def publish(
    work: Path, out: Path, verdict: str, stale: Callable[[Path], Iterable[str]] | None = None
) -> list[Path]:
    """Move all files from a `work_folder` into ``out``, the file ``verdict`` last.

    ``stale`` is called under the lock of ``out`` and names files of earlier runs. Those that this
    run did not make again are removed. If a file cannot be moved, the new files and the old verdict
    are removed. Returns the paths of the new files. Raises OSError.
    """
    files = (path for path in work.rglob("*") if not path.is_dir())
    names = {path.relative_to(work).as_posix() for path in files}
    others = sorted(names - {verdict})
    in_order = [*others, verdict]
    refuse_obstacles(out, in_order)
    for path in work.rglob("*"):
        sync(path)
    with locked_folder(out):
        earlier = list(stale(out)) if stale else []
        _remove(out, [verdict])
        sync(out)
        _remove(out, [name for name in earlier if name not in names and _is_inside(out, name)])
        try:
            for name in others:
                _move(name, work, out)
            for folder in {(out / name).parent for name in others}:
                sync(folder)  # before the verdict says that the other files are there
            _move(verdict, work, out)
            sync(out)
        except BaseException:
            _remove(out, in_order)
            raise
    return [out / name for name in in_order]


def _move(name: str, work: Path, out: Path) -> None:
    (out / name).parent.mkdir(parents=True, exist_ok=True)
    _replace(work / name, out / name)


def _is_inside(out: Path, name: str) -> bool:
    """Whether the path ``name`` stays within the folder ``out``, also through links."""
    path = PurePosixPath(name)
    is_relative = bool(path.parts) and not path.is_absolute() and ".." not in path.parts
    return is_relative and (out / name).parent.resolve().is_relative_to(out.resolve())


def refuse_obstacles(out: Path, names: Iterable[str]) -> None:
    """Raise OSError if a folder stands in the place of a file, or a file in that of its folder."""
    for name in names:
        if (out / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(out / name))
        for folder in _folders(out, name):
            if folder.exists() and not folder.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _remove(out: Path, names: Iterable[str]) -> None:
    """Delete files, and their folders if they are then empty."""
    for name in names:
        if not (out / name).is_dir():
            (out / name).unlink(missing_ok=True)
        for folder in _folders(out, name):
            with suppress(OSError):  # the folder is missing, or holds other files
                folder.rmdir()


def _folders(out: Path, name: str) -> list[Path]:
    """Folders between ``out`` and the file ``name``, the inner ones first."""
    return [out / folder for folder in [*PurePosixPath(name).parents][:-1]]
