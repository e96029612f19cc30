"""Read logs that no one here wrote, and compare with what their own libraries read.

python tests/studies/foreign.py FOLDER

FOLDER has recordings of any format: clones of the projects that
`tests/logs/bus/samples/SOURCES.txt` lists. Frames are decoded with a DBC that has a signal for each
byte of each identifier of the log; where theirs finds no frame that a DBC can describe, with one of
another identifier. One line a file: what python-can or asammdf reads, and what this program reads
or why it refuses. Pointers of git LFS are left out. Ends with the counts of each format:

read       as many bytes or samples as theirs         empty      theirs has none, ours reads none
refused    by ours only                               both       refused by both
DIFFERENT  another number                             TRACEBACK  an error of another kind
"""

import argparse
import logging
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from calib.base.bounded import POINTER  # noqa: E402
from calib.base.errors import BrakeCalError, LogError  # noqa: E402
from calib.logs.channel_map import ChannelMap, DatabaseFile, Databases  # noqa: E402
from calib.logs.formats import RECORDINGS, ending_of  # noqa: E402
from calib.logs.read import open_log  # noqa: E402
from calib.logs.source import Recording  # noqa: E402

EXTENDED = 1 << 31
FRAME = "CAN_DataFrame"
NOBODY = [(0x7FE, False)]
"""Identifiers for a DBC where a log has none that a DBC can describe."""


def by_python_can(path: Path) -> dict[tuple[int, bool], int]:
    """Number of bytes of all data frames, by identifier."""
    import can

    found: Counter[tuple[int, bool]] = Counter()
    with can.LogReader(path) as reader:
        for m in reader:
            legal = m.arbitration_id < 1 << 11 or m.is_extended_id  # what a DBC can describe
            if legal and not (m.is_error_frame or m.is_remote_frame):
                found[m.arbitration_id, m.is_extended_id] += len(m.data)
    return found


def database(identifiers: "list[tuple[int, bool]]") -> str:
    """A DBC with one signal for each byte of 64."""
    rows = ['VERSION ""', "NS_ :", "BS_:", "BU_: A"]
    for number, extended in identifiers:
        rows.append(f"BO_ {number | EXTENDED * extended} M{number:X}{'x' * extended}: 64 A")
        rows += [f' SG_ B{i} : {8 * i}|8@1+ (1,0) [0|255] "" A' for i in range(64)]
    return "\n".join(rows) + "\n"


def by_us(path: Path, identifiers: "list[tuple[int, bool]]", folder: Path) -> int:
    """Number of bytes of all frames, or of samples of all channels; raises BrakeCalError."""
    files = ()
    if identifiers:
        (folder / "all.dbc").write_text(database(identifiers))
        files = (DatabaseFile(folder / "all.dbc"),)
    with open_log(path, ChannelMap("map", {}, databases=Databases(files))) as opened:
        source = opened.source
        assert isinstance(source, Recording)
        return sum(size_of(source, index) for index in range(1, len(source.columns)))


def size_of(opened: Recording, index: int) -> int:
    """Number of values of a column; 0 if it holds text."""
    try:
        return opened.read([index])[0].values.size
    except LogError as error:
        if error.expected != "a numeric channel":
            raise
        return 0


def by_asammdf(path: Path) -> tuple[dict[tuple[int, bool], int], int]:
    """Number of bytes of all data frames by identifier, and of samples of all other channels."""
    import asammdf

    frames: Counter[tuple[int, bool]] = Counter()
    samples = 0
    with asammdf.MDF(path) as mdf:
        for number, group in enumerate(mdf.groups):
            names = {channel.name for channel in group.channels}
            if f"{FRAME}.ID" in names:
                frames += bytes_of_frames(mdf, number, names)
            elif not any(name.startswith(("CAN_", "LIN_")) for name in names):
                places = set(range(len(group.channels))) - {mdf.masters_db.get(number)}
                wanted = [(None, number, i) for i in sorted(places)]
                found = [x.samples for x in mdf.select(wanted, ignore_value2text_conversions=True)]
                samples += sum(x.size for x in found if x.ndim == 1 and x.dtype.kind in "biuf")
    return frames, samples


def bytes_of_frames(mdf: Any, number: int, names: set[str]) -> "Counter[tuple[int, bool]]":
    """Number of bytes by identifier in one group of data frames."""
    ids = mdf.get(f"{FRAME}.ID", group=number).samples.astype(int)
    sizes = mdf.get(f"{FRAME}.DataLength", group=number).samples.astype(int)
    ide = f"{FRAME}.IDE"
    extended = mdf.get(ide, group=number).samples if ide in names else ids > 0x7FF
    found: Counter[tuple[int, bool]] = Counter()
    for identifier, is_long, size in zip(ids & 0x1FFFFFFF, extended, sizes, strict=True):
        found[int(identifier), bool(is_long)] += int(size)
    return found


def is_pointer(path: Path) -> bool:
    """Whether a file is a pointer of git LFS."""
    with path.open("rb") as file:
        return file.read(len(POINTER)) == POINTER


def judged(path: Path, folder: Path) -> tuple[str, str]:
    """What came of a file, in a word, and the line about it."""
    try:
        mdf = path.suffix.lower() in (".mf4", ".mdf", ".dat")
        frames, samples = by_asammdf(path) if mdf else (by_python_can(path), 0)
        theirs = samples + sum(frames.values())
        told = f"{theirs} values"
    except Exception as error:  # theirs refuses it, in any way
        frames, theirs, told = {}, -1, f"refused ({type(error).__name__})"
    try:
        ours = by_us(path, sorted(frames) or ([] if mdf else NOBODY), folder)
    except BrakeCalError as error:
        word = {-1: "both", 0: "empty"}.get(theirs, "refused")
        return word, f"theirs {told}; ours refused: {error.what}; {error.expected or ''}"
    except Exception as error:  # what this is run for
        return "TRACEBACK", f"theirs {told}; ours {type(error).__name__}: {error}"
    word = "empty" if ours == theirs == 0 else "read" if ours == theirs else "DIFFERENT"
    return word, f"theirs {told}; ours {ours}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    counts: Counter[tuple[str, str]] = Counter()
    paths = sorted(p for p in chosen.folder.rglob("*") if p.is_file())
    for path in (p for p in paths if ending_of(p) in RECORDINGS and not is_pointer(p)):
        with tempfile.TemporaryDirectory() as folder:
            word, line = judged(path, Path(folder))
        counts[ending_of(path), word] += 1
        print(f"{word:9} {path.relative_to(chosen.folder)}: {line}", flush=True)
    for (ending, word), number in sorted(counts.items()):
        print(f"{ending:8} {word:9} {number:4}")


if __name__ == "__main__":
    main()
