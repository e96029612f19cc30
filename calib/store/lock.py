"""One writer at a time in a folder; the system takes the lock from a process that ends."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, which is made if it is not there; waits for its holder.

    A folder that stays empty and was made here is removed. The lock holds between processes of one
    computer, and between computers where the file system passes `flock` on. Raises OSError.
    """
    made = not folder.exists()
    handle = _lock(folder)
    try:
        yield
    finally:
        if made:
            with suppress(OSError):
                folder.rmdir()
        os.close(handle)


def _lock(folder: Path) -> int:
    """Open and lock the folder; make it again where its last holder removed it, empty."""
    while True:
        folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(folder, os.O_RDONLY)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX)
            if os.fstat(handle).st_nlink > 0:
                return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)
