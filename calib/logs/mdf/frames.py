"""Raw frames of a CAN bus in an MDF file."""

from typing import Any

import numpy as np

from calib.errors import LogError
from calib.logs.bus.frames import Frames, Key

FRAME = "CAN_DataFrame"
"""Name of the channel for data frames in the ASAM standard."""


def bus_groups(mdf: Any) -> list[int]:
    """Groups that contain bus frames instead of measured channels."""
    return [
        number
        for number, group in enumerate(mdf.groups)
        if any(c.name.startswith(("CAN_", "LIN_")) and "Frame" in c.name for c in group.channels)
    ]


def frames_in(mdf: Any, groups: list[int], known: frozenset[Key], where: str) -> list[Frames]:
    """Frames of the identifiers in ``known``, by bus and identifier.

    Raises LogError for fewer frames than a group counts, and if asammdf cannot read them.
    """
    found = []
    for number in groups:
        names = {c.name for c in mdf.groups[number].channels}
        if f"{FRAME}.DataBytes" in names and mdf.groups[number].channel_group.cycles_nr:
            found += _frames(mdf, number, known, where)
    return _joined(found)


def _joined(found: list[Frames]) -> list[Frames]:
    """One entry for each bus and identifier: loggers have groups for received and sent frames."""
    parts: dict[tuple[str, Key], list[Frames]] = {}
    for item in found:
        parts.setdefault((item.bus, item.key), []).append(item)
    return [_one(items) if len(items) > 1 else items[0] for items in parts.values()]


def _one(items: list[Frames]) -> Frames:
    """Join frames of one identifier in the order of time; equal times stay in order."""
    time = np.concatenate([item.time for item in items])
    width = max(item.data.shape[1] for item in items)
    data = np.concatenate(
        [np.pad(item.data, ((0, 0), (0, width - item.data.shape[1]))) for item in items]
    )
    length = np.concatenate([item.length for item in items])
    order = np.argsort(time, kind="stable")
    return Frames(items[0].bus, items[0].key, time[order], data[order], length[order])


def _frames(mdf: Any, number: int, known: frozenset[Key], where: str) -> list[Frames]:
    try:
        identifier = mdf.get(f"{FRAME}.ID", group=number)
        others = {k: _field(mdf, number, k) for k in ("IDE", "BusChannel", "DataLength")}
        data = mdf.get(f"{FRAME}.DataBytes", group=number).samples
    except Exception as cause:  # a damaged file makes asammdf raise almost anything
        raise LogError(
            f"asammdf cannot read the frames: {str(cause) or type(cause).__name__}",
            where=where,
            expected="a complete and undamaged MDF file",
        ) from cause
    ids, time = identifier.samples, identifier.timestamps
    cycles = int(mdf.groups[number].channel_group.cycles_nr)
    if not len(data) == ids.size == cycles:
        raise LogError(
            f"{min(len(data), ids.size)} of {cycles} frames can be read", where=where,
            expected="all that the group counts", do="copy the log again",
        )  # fmt: skip
    ids = ids.astype(np.int64)  # loggers store 11 bits of identifier in 16
    bare = ids & 0x1FFFFFFF
    extended = others["IDE"].astype(bool) if others["IDE"] is not None else ids > 0x7FF
    bus = others["BusChannel"] if others["BusChannel"] is not None else np.zeros(ids.size, int)
    length = others["DataLength"]
    if length is None:
        length = np.full(ids.size, data.shape[1])
    if length.max(initial=0) > data.shape[1]:
        raise LogError(
            f"a frame has a length of {length.max()} bytes, its record {data.shape[1]}",
            where=where,
            expected="frames within their records",
            do="the file is damaged: copy the log again",
        )
    result = []
    for key in sorted(known):
        mine = (bare == key[0]) & (extended == key[1])
        for channel in np.unique(bus[mine]):
            at = np.flatnonzero(mine & (bus == channel))
            width = int(length[at].max())
            result.append(
                Frames(
                    f"{int(channel)}", key, time[at],
                    np.ascontiguousarray(data[at, :width], np.uint8), length[at].astype(np.uint8),
                )
            )  # fmt: skip
    return result


def _field(mdf: Any, number: int, name: str) -> Any:
    """Samples of one field of the frames, or None if the file does not have it."""
    names = {c.name for c in mdf.groups[number].channels}
    full = f"{FRAME}.{name}"
    return mdf.get(full, group=number).samples if full in names else None
