"""A log whose channels do not share one clock: traces, each with its own timestamps."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from calib.logs.source import Array, Column

TIME = Column("time", "s")
"""First column of every recording: the common clock after resampling."""


@dataclass(frozen=True)
class ChannelTrace:
    """One channel as it was recorded.

    ``clock`` names the timestamps in words; traces of equal ``clock`` share ``time``.
    ``time`` [s], in the order of the file, shape (n,); ``values`` as written, NaN where the file
    marks them as invalid, shape (n,); ``state`` is true if they must not be interpolated, such as a
    gear or a flag.
    """

    clock: str
    time: Array
    values: Array
    state: bool = False


def _nothing() -> None:
    """Do nothing: there is no open file to close."""


@dataclass(frozen=True)
class Recording:
    """An opened log with several sample rates.

    ``columns`` begin with ``TIME``; ``read`` takes indices of the others and returns one trace
    each; ``notes`` on oddities that are no errors; ``close`` closes the file.
    """

    columns: tuple[Column, ...]
    read: Callable[[Sequence[int]], list[ChannelTrace]]
    notes: tuple[str, ...] = ()
    close: Callable[[], None] = _nothing


def named(columns: list[Column]) -> tuple[Column, ...]:
    """The columns of a recording, with `TIME` before them."""
    return (TIME, *columns)
