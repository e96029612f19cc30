"""Read files of users safely: only regular files, and none above the size limit of its kind.

Reading a named pipe may wait for ever, a device has no end, and a few kilobytes of gzip can unpack
to gigabytes. With these limits, reading a file takes at most about 1 GB of memory and 20 s. With
the environment variable `BRAKE_CAL_MOST_LOG=500`, a log may have 500 MB.
"""

import errno
import math
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path
from typing import NamedTuple

from calib.base.errors import BrakeCalError, SettingsError

_MEGA = 1_000_000


class FileKind(NamedTuple):
    """A kind of file, and its size limit in ``megabytes``, packed and unpacked."""

    name: str
    megabytes: float

    @property
    def variable(self) -> str:
        """Name of the environment variable with which users set another limit [MB]."""
        return f"BRAKE_CAL_MOST_{self.name.upper()}"

    @property
    def max_bytes(self) -> int:
        """Size limit [bytes]. Raises SettingsError for a variable that is no number above 0."""
        setting = os.environ.get(self.variable, "")
        try:
            megabytes = float(setting) if setting else self.megabytes
        except ValueError:
            megabytes = math.nan  # is refused below
        if not 0 < megabytes < math.inf:
            flaw, expected = f"{setting!r} is no size", "a number of MB, such as 500"
            raise SettingsError(flaw, where=self.variable, expected=expected)
        return int(megabytes * _MEGA)

    def size_message(self, beginning: str = "it has") -> str:
        """Message for a file above the limit; it begins with "it has more than 120 MB"."""
        limit = f"{self.max_bytes / _MEGA:g} MB"
        return f"{beginning} more than {limit}; if it is meant, set {self.variable} to more MB"


LOG = FileKind("log", 120)  # text and Parquet; an hour of 13 channels at 200 Hz is 100 MB of text
RECORDING = FileKind("recording", 600)  # MDF and bus logs; loggers split their files at 512 MB
DBC = FileKind("dbc", 8)
TOML = FileKind("toml", 1)
PLAN = FileKind("plan", 16)
EFFECT = FileKind("effect", 1)
TYRE = FileKind("tyre", 1)
CALIBRATION = FileKind("calibration", 16)  # DCM and CDF
VALIDATION = FileKind("validation", 16)  # JSON that `validate` and `station` wrote
RESULT = FileKind("result", 120)  # Parquet that `validate` wrote
PROGRAM = FileKind("program", 512)  # ELF; without debug information it has about 5 MB
TABLE = FileKind("table", 16)  # each file of a version in a store
JOURNAL = FileKind("journal", 64)  # some 100,000 lines
KEY = FileKind("key", 0.016384)  # keys and signatures: no file of minisign is longer

# Without O_NONBLOCK, opening a pipe that nobody writes to blocks. Windows has O_BINARY alone.
_FLAG_NAMES = ("O_NONBLOCK", "O_CLOEXEC", "O_BINARY")
_READ_FLAGS = os.O_RDONLY | sum(getattr(os, name, 0) for name in _FLAG_NAMES)


def open_bounded(path: Path, kind: FileKind) -> BufferedReader:
    """Open a regular file, or a link to it. Raises OSError, also for a pipe or a file too large."""
    try:
        handle = os.open(path, _READ_FLAGS)
    except ValueError as cause:  # a null character in the name
        raise OSError(errno.EINVAL, "no such name is possible", str(path)) from cause
    file = os.fdopen(handle, "rb")
    try:
        status = os.fstat(handle)
        if not stat.S_ISREG(status.st_mode):
            node = "a directory" if stat.S_ISDIR(status.st_mode) else "a pipe or a device"
            raise OSError(errno.EINVAL, f"{node} is not a file", str(path))
        if status.st_size > kind.max_bytes:
            raise OSError(errno.EFBIG, kind.size_message(), str(path))
    except BaseException:
        file.close()
        raise
    return file


def read_bounded(path: Path, kind: FileKind) -> bytes:
    """Return the bytes of a regular file. Raises OSError as `open_bounded` does."""
    with open_bounded(path, kind) as file:
        limit = kind.max_bytes
        data = file.read(limit + 1)
    if len(data) > limit:  # the file grew, or its system did not tell its size
        raise OSError(errno.EFBIG, kind.size_message(), str(path))
    return data


@contextmanager
def errors_as(error: Callable[..., BrakeCalError], where: object, expected: str) -> Iterator[None]:
    """Raise ``error`` for the file ``where`` in place of any OSError within the context."""
    try:
        yield
    except (FileNotFoundError, NotADirectoryError) as cause:
        raise error("no such file", where=where, expected=expected, do="check the path") from cause
    except OSError as cause:
        flaw, do = f"cannot be read ({cause.strerror})", ""
        if os.path.isdir(str(where)):
            flaw, do = "is a folder", "name the files in it"
        raise error(flaw, where=where, expected=expected, do=do) from cause


POINTER = b"version https://git-lfs"  # the first bytes of a file that git LFS has not fetched


def bytes_of(
    path: Path, kind: FileKind, error: Callable[..., BrakeCalError], expected: str
) -> bytes:
    """Return the bytes of a regular file. Raises ``error``, which says what was ``expected``."""
    with errors_as(error, path, expected):
        data = read_bounded(path, kind)
    if data.startswith(POINTER):
        flaw, do = "a pointer of git LFS, not the file itself", "get the file: git lfs pull"
        raise error(flaw, where=path, expected=expected, do=do)
    return data
