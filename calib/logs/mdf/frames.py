"""Raw frames of a CAN bus in an MDF file."""

from typing import Any

import numpy as np

from calib.errors import LogError
from calib.logs.bus.frames import Frames, Known, joined

FRAME = "CAN_DataFrame"
"""Name of the channel for data frames in the ASAM standard."""


def bus_groups(mdf: Any) -> list[int]:
    """Groups that contain bus frames instead of measured channels."""
    return [
        number
        for number, group in enumerate(mdf.groups)
        if any(c.name.startswith(("CAN_", "LIN_")) and "Frame" in c.name for c in group.channels)
    ]


def frames_in(mdf: Any, groups: list[int], known: Known, where: str) -> list[Frames]:
    """Frames that are ``known``, by bus and identifier.

    Raises LogError for fewer frames than a group counts, and if asammdf cannot read them.
    """
    found = []
    for number in groups:
        names = {c.name for c in mdf.groups[number].channels}
        if f"{FRAME}.DataBytes" in names and mdf.groups[number].channel_group.cycles_nr:
            found += _frames(mdf, number, known, where)
    return joined(found, lambda item: (item.bus, item.key))


def _frames(mdf: Any, number: int, known: Known, where: str) -> list[Frames]:
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
    fields = [ids, *(field for field in others.values() if field is not None)]
    if data.ndim != 2 or any(f.ndim != 1 or f.dtype.kind not in "biuf" for f in fields):
        raise LogError(
            "the fields of its frames are not numbers",
            where=where,
            expected="identifier, bus, length and bytes of each frame",
            do="the file is damaged: copy the log again",
        )
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
    codes = bus.astype(np.int64) << 30 | extended.astype(np.int64) << 29 | bare
    result = []
    for code in np.unique(codes).tolist():
        name, key = f"{code >> 30}", (code & 0x1FFFFFFF, bool(code >> 29 & 1))
        if known(name, key):
            at = np.flatnonzero(codes == code)
            part = np.ascontiguousarray(data[at, : int(length[at].max())], np.uint8)
            result.append(Frames(name, key, time[at], part, length[at].astype(np.uint16), at))
    return result


def _field(mdf: Any, number: int, name: str) -> Any:
    """Samples of one field of the frames, or None if the file does not have it."""
    names = {c.name for c in mdf.groups[number].channels}
    full = f"{FRAME}.{name}"
    return mdf.get(full, group=number).samples if full in names else None
