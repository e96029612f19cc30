"""What is printed arrives, or the run says that it did not: a full disk, a reader that went away.

The layers above a stream treat an OSError each in its own way: rich, the parser of the command
line, the interpreter at its exit. So the lowest layer raises what none of them knows.
"""

import io
import os
import sys
from collections.abc import Callable
from typing import Any

from calib.base.errors import AnswerError

OUT, ERR = 1, 2
"""File descriptors of stdout and stderr."""


class _NotWritten(Exception):
    """A stream took nothing more; its cause is the OSError."""


class _Descriptor(io.FileIO):
    """A file descriptor whose failure is `_NotWritten`."""

    def write(self, data: Any) -> int:
        try:
            return super().write(data)
        except OSError as error:
            raise _NotWritten(error.strerror) from error


def delivered(work: Callable[[], int]) -> int:
    """Exit code of ``work`` once all that it printed is written.

    It is 0, without a word, where a reader went away, as after `head`. Where something else is in
    the way it is that of `AnswerError`, with a line on stderr if that takes one.
    """
    sys.stdout, sys.stderr = _guarded(sys.stdout, OUT), _guarded(sys.stderr, ERR)
    try:
        code = work()
        sys.stdout.flush()
        sys.stderr.flush()
    except _NotWritten as lost:
        return _undelivered(lost)
    return code


def _undelivered(lost: _NotWritten) -> int:
    """What is still in the streams is discarded: the interpreter flushes them at its exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, OUT)
    if isinstance(lost.__cause__, BrokenPipeError):
        os.dup2(nowhere, ERR)
        return 0
    try:
        sys.stderr.write(f"error: {AnswerError(f'the answer could not be written ({lost})')}\n")
        sys.stderr.flush()
    except _NotWritten:
        os.dup2(nowhere, ERR)
    return AnswerError.exit_code


def _guarded(stream: Any, number: int) -> Any:
    """``stream`` on a `_Descriptor`; as it is where it is not the one that the shell has given.

    The shell may have closed it: then nothing can be written to stdout, and messages go nowhere.
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
    how = {"errors": stream.errors, "line_buffering": stream.line_buffering}
    return io.TextIOWrapper(guard, stream.encoding, **how)
