"""Vector BLF, read with python-can; the sizes in its header are compared with what is there.

header   LOGG, size of the file, size of all objects unpacked, number of objects, start and stop

The number of objects is only a hint: Vector's writers leave out objects of type 115, python-can
counts them.
"""

import struct
from dataclasses import dataclass
from pathlib import Path

from calib.errors import LogError
from calib.logs.bus.blf_objects import FoundObjects, walk
from calib.logs.bus.databases import Databases
from calib.logs.bus.recording import gathered, recording, require_dbc
from calib.logs.extra import need
from calib.logs.recording import Recording

_HEADER = struct.Struct("<4sL8xQQL36x")


@dataclass(frozen=True)
class Objects:
    """Number of ``all`` objects, of the ``frames`` among them, and the number in the header."""

    all: int
    frames: int
    counted: int

    @property
    def notes(self) -> tuple[str, ...]:
        """A note if the header counts another number of objects."""
        if self.all == self.counted:
            return ()
        return (
            f"the header counts {self.counted} objects, the file has {self.all}: all sizes agree, "
            "so none is missing (writers differ in what they count)",
        )


def open_blf(path: Path, dbc: Databases) -> Recording:
    """Open a BLF file.

    Raises LogError for a file that is not whole (`check_whole`; python-can reads such a file
    without an error), if python-can or a DBC is missing, and if no frame is described by the DBC.
    """
    where = str(path)
    can = need("can", "can", where)
    known = require_dbc(dbc, "can", where)
    objects = check_whole(path)
    with can.BLFReader(path) as reader:
        found = gathered(reader, known, where)
    if len(found.times) != objects.frames:
        raise LogError(
            f"{len(found.times)} of {objects.frames} frames can be read: "
            f"{objects.frames - len(found.times)} are missing",
            where=where,
            expected="all of them",
            do="copy the log again",
        )
    return recording(found, known, objects.notes, where)


def check_whole(path: Path) -> Objects:
    """Compare the sizes in the header and in the containers with what is there.

    The number of objects decides only if the header has no size of the unpacked objects. Raises
    LogError for a file that is not BLF, not finished, damaged or not whole.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        begin = file.read(_HEADER.size)
        if len(begin) < _HEADER.size or begin[:4] != b"LOGG":
            raise LogError("not a BLF file", where=path, expected="a file that begins with LOGG")
        _, first, promised, unpacked, count = _HEADER.unpack(begin)
        if not promised or not (unpacked or count):
            raise LogError(
                "the recorder did not finish the file: its header counts no objects",
                where=path,
                expected="a header with sizes, to compare with what is there",
                do="open it with the tool that wrote it and save it again",
            )
        if size < promised:
            raise LogError(
                f"the file has {size} of {promised} bytes: {promised - size} are missing "
                f"({100 * (1 - size / promised):.0f} % of the file)",
                where=path,
                expected=f"the {count} objects that its header counts",
                do="copy the log again",
            )
        file.seek(first)
        found = walk(file, path)
    found.unpacked += first
    _require_all(found, unpacked, count, path)
    return Objects(found.objects, found.frames, count)


def _require_all(found: FoundObjects, unpacked: int, count: int, path: Path) -> None:
    """Raise LogError for less than the header states, or an object that is not complete.

    ``found.padding`` is allowed for, because writers may count it or not.
    """
    short = unpacked - found.unpacked - found.padding
    if short > 0 or (not unpacked and found.objects < count):
        sizes = f"{found.unpacked} of {unpacked} bytes (unpacked) and " if unpacked else ""
        raise LogError(
            f"the file has {sizes}{found.objects} of {count} objects: some are missing",
            where=path,
            expected="as much as the header states",
            do="copy the log again",
        )
    if found.rest.strip(b"\0"):
        raise LogError(
            f"the last object is not complete, after {found.objects} whole ones",
            where=path,
            expected="whole objects",
            do="copy the log again",
        )
