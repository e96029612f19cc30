"""Write files completely or not at all."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


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
