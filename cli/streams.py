"""Make a run fail if stdout or stderr cannot be written: on a full disk, or into a closed pipe.

rich, typer and the interpreter hide some errors of type OSError. They do not know `NotWritten`. So
stdout and stderr raise `NotWritten` instead, and `delivered` turns that error into an exit code.
"""

import errno
import io
import os
import sys
from collections.abc import Callable
from typing import Any

from calib.base.errors import AnswerError

OUT, ERR = 1, 2  # file descriptors of stdout and stderr


class NotWritten(Exception):
    """A stream cannot be written. The cause of this error is the OSError."""


class _Descriptor(io.FileIO):
    """A file descriptor whose failure is `NotWritten`."""

    def write(self, data: Any) -> int:
        try:
            return super().write(data)
        except OSError as error:
            raise NotWritten(error.strerror) from error


def delivered(work: Callable[[], int]) -> int:
    """Return the exit code of ``work``, or that of an error if its output cannot be written."""
    sys.stdout, sys.stderr = _guarded(sys.stdout, OUT), _guarded(sys.stderr, ERR)
    try:
        code = work()
        sys.stdout.flush()
        sys.stderr.flush()
    except NotWritten as failure:
        return _undelivered(failure)
    return code


def _undelivered(failure: NotWritten) -> int:
    """Return 0 if the reader of a pipe has ended, as `head` does, else the code of an error."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, OUT)  # discards what the interpreter flushes at its exit
    cause = failure.__cause__
    # Windows has EINVAL for a closed pipe
    is_closed_on_windows = sys.platform == "win32" and getattr(cause, "errno", 0) == errno.EINVAL
    if is_closed_on_windows or isinstance(cause, BrokenPipeError):
        os.dup2(nowhere, ERR)
        return 0
    try:
        sys.stderr.write(f"error: {AnswerError(f'the answer could not be written ({failure})')}\n")
        sys.stderr.flush()
    except NotWritten:
        os.dup2(nowhere, ERR)
    return AnswerError.exit_code


def _guarded(stream: Any, number: int) -> Any:
    """Return a stream that raises `NotWritten`, in place of ``stream`` of descriptor ``number``.

    A stream that a test or a notebook has replaced is returned as it is.
    """
    if stream is None:  # the shell has closed it: stdout then fails, and stderr is discarded
        nowhere = os.open(os.devnull, os.O_RDONLY if number == OUT else os.O_WRONLY)
        return io.TextIOWrapper(io.BufferedWriter(_Descriptor(nowhere, "w")), write_through=True)
    binary = getattr(stream, "buffer", None)
    raw = getattr(binary, "raw", binary)
    if not isinstance(raw, io.FileIO) or raw.fileno() != number:
        return stream
    stream.flush()
    guard = io.BufferedWriter(_Descriptor(number, "w", closefd=False))
    settings = {"errors": "backslashreplace", "line_buffering": stream.line_buffering}
    return io.TextIOWrapper(guard, stream.encoding, **settings)
