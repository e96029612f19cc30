"""Streams whose failure nobody swallows: a full disk or a closed pipe must not lose output.

rich, typer and the interpreter each treat an OSError in their own way. So stdout and stderr raise
`NotWritten`, which none of them knows, and `delivered` turns it into an exit code.
"""

import errno
import io
import os
import sys
from collections.abc import Callable
from typing import Any

from calib.base.errors import AnswerError

OUT, ERR = 1, 2
"""File descriptors of stdout and stderr."""


class NotWritten(Exception):
    """A stream cannot be written; the cause is the OSError."""


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
    """Return 0 if the reader has gone, as `head` does; else print an error, and return its code."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, OUT)  # what the interpreter flushes at its exit is discarded
    cause = failure.__cause__
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
    """Return ``stream`` on a `_Descriptor`, if it is that of the shell, else as it is.

    ``number`` is its file descriptor. The shell may have closed the stream: then writing to stdout
    fails, and what is written to stderr is discarded.
    """
    if stream is None:
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
