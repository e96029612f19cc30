"""Formats with several sample rates, such as bus frames: how each file ending is opened."""

from collections.abc import Sequence

from calib.errors import LogError
from calib.logs.bus.asc import open_asc
from calib.logs.bus.blf import open_blf
from calib.logs.bus.candump import open_candump
from calib.logs.bus.compressed import Open, packed
from calib.logs.bus.trc import open_trc
from calib.logs.mdf import open_mdf
from calib.logs.recording import ChannelTrace, Recording
from calib.logs.resample import Wanted, on_one_clock
from calib.logs.source import Array, ColumnSource

_BUS: dict[str, Open] = {
    ".blf": open_blf,
    ".asc": open_asc,
    ".log": open_candump,
    ".trc": open_trc,
}

RECORDINGS: dict[str, Open] = {
    ".mf4": open_mdf,
    ".mdf": open_mdf,
    ".dat": open_mdf,
    **_BUS,
    **{f"{ending}.gz": packed(opener) for ending, opener in _BUS.items()},
}
"""Opening function by file ending; each takes the path and the DBC files of the channel map."""


def as_source(opened: Recording, where: str) -> ColumnSource:
    """All channels of a recording on one clock, like a table; closes the recording.

    Used before the columns are assigned to channels. Reading a column that the recording refuses
    raises its LogError.
    """
    try:
        traces, refused = dict[int, ChannelTrace](), dict[int, LogError]()
        for index in range(1, len(opened.columns)):
            try:
                traces[index] = opened.read([index])[0]
            except LogError as error:
                refused[index] = error
    finally:
        opened.close()
    wanted = [Wanted(_name(opened, i), trace, trace.state) for i, trace in traces.items()]
    resampled = on_one_clock(wanted, where)
    arrays = {0: resampled.time, **dict(zip(traces, resampled.values, strict=True))}

    def read(indices: Sequence[int]) -> list[Array]:
        for index in indices:
            if index in refused:
                raise refused[index]
        return [arrays[index] for index in indices]

    rates = {i: resampled.rates[n] for i in traces if (n := _name(opened, i)) in resampled.rates}
    return ColumnSource(opened.columns, read, opened.notes + resampled.notes, rates)


def _name(opened: Recording, index: int) -> str:
    column = opened.columns[index]
    return column.full or column.name
