"""What a reader hands over whose channels do not share one clock: traces, each with its own."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from calib.logs.source import Array, Column

TIME = Column("time", "s")
"""First column of every recording: the one clock onto which the others will be brought."""


@dataclass(frozen=True)
class ChannelTrace:
    """One channel as it was recorded.

    ``clock`` says in words on what it was sampled; traces of equal ``clock`` share ``time``.
    ``time`` [s], in the order of the file, shape (n,); ``values`` as written, NaN where the file
    marks them as invalid, shape (n,); ``state`` for what has no values in between: a gear, a flag.
    """

    clock: str
    time: Array
    values: Array
    state: bool = False


def _nothing() -> None:
    """Close what holds nothing open."""


@dataclass(frozen=True)
class Recording:
    """A file of several rasters that was opened.

    ``columns`` begin with ``TIME``; ``read`` takes indices of the others and returns one trace
    each; ``notes`` what was odd but no error; ``close`` frees the file.
    """

    columns: tuple[Column, ...]
    read: Callable[[Sequence[int]], list[ChannelTrace]]
    notes: tuple[str, ...] = ()
    close: Callable[[], None] = _nothing


def named(columns: list[Column]) -> tuple[Column, ...]:
    """The columns of a recording, with `TIME` before them."""
    return (TIME, *columns)
