"""Open files of others safely: regular files alone, not larger than the bound of their kind.

A named pipe would wait for ever, a device has no end, and a few kilobytes of gzip can unpack to
gigabytes. The bounds keep a reader below about 1 GB and 20 s. A variable raises a bound:
`BRAKE_CAL_MOST_LOG=500 brake-cal check long.csv` allows logs of 500 MB.
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
    """A kind of file, and the ``megabytes`` that one may have or unpack to."""

    name: str
    megabytes: float

    @property
    def variable(self) -> str:
        """Environment variable of another bound [MB]."""
        return f"BRAKE_CAL_MOST_{self.name.upper()}"

    @property
    def most(self) -> int:
        """Largest size [bytes]. Raises SettingsError for a variable that is no number above 0."""
        written = os.environ.get(self.variable, "")
        try:
            megabytes = float(written) if written else self.megabytes
        except ValueError:
            megabytes = math.nan
        if not 0 < megabytes < math.inf:
            flaw, expected = f"{written!r} is no size", "a number of MB, such as 500"
            raise SettingsError(flaw, where=self.variable, expected=expected)
        return int(megabytes * _MEGA)

    def excess(self, subject: str = "it has") -> str:
        """Message for a file that is too large."""
        most = f"{self.most / _MEGA:g} MB"
        return f"{subject} more than {most}; if it is meant, set {self.variable} to more MB"


# Text and Parquet, as unpacked: an hour of 13 channels at 200 Hz has 100 MB of text.
LOG = FileKind("log", 120)
# MDF and bus logs; loggers begin a new file at 512 MB or before.
RECORDING = FileKind("recording", 600)
DBC = FileKind("dbc", 8)
TOML = FileKind("toml", 1)
PLAN = FileKind("plan", 16)
EFFECT = FileKind("effect", 1)
CALIBRATION = FileKind("calibration", 16)  # DCM and CDF that come back
VALIDATION = FileKind("validation", 16)  # JSON that `validate` and `station` wrote
RESULT = FileKind("result", 120)  # Parquet that `validate` wrote
PROGRAM = FileKind("program", 512)  # ELF; one without debug information is a hundredth of it
TABLE = FileKind("table", 16)  # each file of a version in a store, and what was seen of stores
JOURNAL = FileKind("journal", 64)  # some 100,000 lines
KEY = FileKind("key", 0.016384)  # keys and signatures: no file of minisign is longer


# without O_NONBLOCK, opening a pipe without a writer blocks; Windows has O_BINARY alone
_NAMES = ("O_NONBLOCK", "O_CLOEXEC", "O_BINARY")
_FLAGS = os.O_RDONLY | sum(getattr(os, name, 0) for name in _NAMES)


def open_bounded(path: Path, kind: FileKind) -> BufferedReader:
    """Open a regular file, or a link to one, for reading.

    Raises OSError with a readable ``strerror``, also for a pipe, a device or too large a file.
    """
    try:
        handle = os.open(path, _FLAGS)
    except ValueError as cause:  # a nul in the name
        raise OSError(errno.EINVAL, "no such name is possible", str(path)) from cause
    file = os.fdopen(handle, "rb")
    try:
        state = os.fstat(handle)
        if not stat.S_ISREG(state.st_mode):
            kind_of_node = "a directory" if stat.S_ISDIR(state.st_mode) else "a pipe or a device"
            raise OSError(errno.EINVAL, f"{kind_of_node} is not a file", str(path))
        if state.st_size > kind.most:
            raise OSError(errno.EFBIG, kind.excess(), str(path))
    except BaseException:
        file.close()
        raise
    return file


def read_bounded(path: Path, kind: FileKind) -> bytes:
    """The bytes of a regular file. Raises OSError as `open_bounded` does."""
    with open_bounded(path, kind) as file:
        most = kind.most
        data = file.read(most + 1)
    if len(data) > most:  # it grew, or its system does not know its size
        raise OSError(errno.EFBIG, kind.excess(), str(path))
    return data


POINTER = b"version https://git-lfs"  # begin of a file of git LFS that was not fetched


@contextmanager
def errors_as(error: Callable[..., BrakeCalError], where: object, expected: str) -> Iterator[None]:
    """Raise OSErrors within the context as ``error`` of the file ``where``."""
    try:
        yield
    except (FileNotFoundError, NotADirectoryError) as cause:
        raise error("no such file", where=where, expected=expected, do="check the path") from cause
    except OSError as cause:
        raise error(f"cannot be read ({cause.strerror})", where=where, expected=expected) from cause


def bytes_of(
    path: Path, kind: FileKind, error: Callable[..., BrakeCalError], expected: str
) -> bytes:
    """The bytes of a regular file. Raises ``error``, which names what was ``expected``."""
    with errors_as(error, path, expected):
        data = read_bounded(path, kind)
    if data.startswith(POINTER):
        flaw, do = "a pointer of git LFS, not the file itself", "get the file: git lfs pull"
        raise error(flaw, where=path, expected=expected, do=do)
    return data
