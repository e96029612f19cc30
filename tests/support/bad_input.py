"""The matrix of bad input: each kind of file and each channel against each fault.

`tests/test_bad_input_page.py` runs every cell, and compares it with the tables of
`tests/studies/results/bad_input.md`, which this writes: `python -m tests.support.bad_input`.
"""

import random
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.base.bounded import KINDS
from calib.base.errors import BrakeCalError, LogError
from calib.logs.log import Log
from calib.logs.read import read_log
from calib.run.check import Findings, check
from calib.store.journal import Journal
from calib.store.snapshot import Snapshot
from tests.support.fuzzed import READERS, ROOT, SEDAN, Reader

PAGE = ROOT / "tests" / "studies" / "results" / "bad_input.md"
BEGIN, END = "<!-- made by tests/support/bad_input.py -->", "<!-- end of what was made -->"
LARGE = 2_000_000

Text = list[list[str]]
"""Cells of a CSV, the header first."""


def of_another_kind(name: str) -> bytes:
    """A good file of another kind: a picture, which no reader takes."""
    return (ROOT / "sample_logs" / "figures" / "table.png").read_bytes()[:20_000]


FILE_FAULTS: dict[str, Callable[[str, bytes], bytes | None]] = {
    "missing": lambda name, good: None,
    "empty": lambda name, good: b"",
    "truncated": lambda name, good: good[: len(good) // 2],
    "wrong type": lambda name, good: of_another_kind(name),
    "huge": lambda name, good: good + b"\n" * LARGE,
    "hostile": lambda name, good: random.Random(5).randbytes(4000),
    "nested": lambda name, good: b"x = " + b"[" * 100_000,
}


def bounds(monkeypatch_to: Callable[[str, str], None]) -> None:
    """Lower the bound of every kind of file to what a huge file here exceeds."""
    for kind in KINDS:
        monkeypatch_to(kind.variable, str(min(kind.megabytes, LARGE / 2e6)))


def of_file(name: str, reader: Reader, fault: str) -> str:
    """What is done with a bad file: refused, or read."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / reader.file
        data = FILE_FAULTS[fault](name, reader.seeds()[0])
        if data is not None:
            path.write_bytes(data)
        try:
            found = reader.read(path)
        except BrakeCalError:
            return "refused"
    return "empty" if found == Snapshot(path.parent, Journal()) else "read"


@cache
def good() -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Names with units, and values, of the ramp with the optional channels beside."""
    path = SEDAN / "ramp_wet_asphalt.csv"
    names = path.read_text().splitlines()[0].split(",")
    values = np.loadtxt(path, delimiter=",", skiprows=1)
    chance = np.random.default_rng(3)
    steering = chance.normal(0.0, 0.2, len(values)).round(3)
    drive = chance.normal(-30.0, 1.0, len(values)).round(2)
    wheel = (values[:, names.index("p_mc [bar]")] + chance.normal(0, 0.1, len(values))).round(2)
    more = ("p_fl [bar]", "p_fr [bar]", "steering [deg]", "T_drive_f [N*m]")
    columns = np.column_stack([values, wheel, wheel + 0.05, steering, drive])
    return (*names, *more), columns


def cells() -> Text:
    names, values = good()
    return [list(names), *([f"{x:.6g}" for x in row] for row in values)]


CHANNELS = ("time", "p_mc", "a_x", "omega_fl", "omega_rl", "v", "p_fl", "steering", "T_drive_f")
OTHER_UNIT = {"s": "ms", "bar": "kPa", "m/s^2": "g", "rad/s": "rpm", "m/s": "km/h", "deg": "rad"}
"""Another unit of the same quantity, which a header may claim wrongly."""


def column_of(text: Text, channel: str) -> int:
    return next(i for i, head in enumerate(text[0]) if head.split(" ")[0] == channel)


def put(value: str, rows: slice) -> Callable[[Text, int], Text]:
    def change(text: Text, at: int) -> Text:
        for row in text[1:][rows]:
            row[at] = value
        return text

    return change


def mapped(function: Callable[[float], float]) -> Callable[[Text, int], Text]:
    def change(text: Text, at: int) -> Text:
        for row in text[1:]:
            row[at] = f"{function(float(row[at])):.6g}"
        return text

    return change


def without(text: Text, at: int) -> Text:
    return [row[:at] + row[at + 1 :] for row in text]


def claimed(text: Text, at: int) -> Text:
    name, _, unit = text[0][at].partition(" [")
    text[0][at] = f"{name} [{OTHER_UNIT.get(unit[:-1], 'kN*m')}]"
    return text


def other_quantity(text: Text, at: int) -> Text:
    text[0][at] = text[0][at].partition(" [")[0] + " [kg]"
    return text


def late(text: Text, at: int) -> Text:
    """Every value half a second late."""
    values = [row[at] for row in text[1:]]
    for row, value in zip(text[1:], [values[0]] * 100 + values[:-100], strict=True):
        row[at] = value
    return text


def doubled(text: Text, at: int) -> Text:
    return [[*row, row[at]] for row in text]


CHANNEL_FAULTS: dict[str, Callable[[Text, int], Text]] = {
    "missing": without,
    "empty": put("", slice(None)),
    "truncated": put("", slice(-300, None)),
    "wrong type": put("high", slice(40, 41)),
    "NaN": put("NaN", slice(40, 140)),
    "infinite": put("inf", slice(40, 41)),
    "out of range": put("1e9", slice(40, 41)),
    "wrong unit": claimed,
    "wrong quantity": other_quantity,
    "wrong sign": mapped(lambda x: -x),
    "shifted": late,
    "duplicated": doubled,
    "constant": mapped(lambda x: 1.0),
    "huge": mapped(lambda x: x * 1e300),
    "hostile": put("\x1b[2J\u202e", slice(40, 41)),
}


def of_channel(channel: str, fault: str) -> str:
    """What `check` says of the ramp with a fault in one channel, beside what it says without.

    refused; not for a fit; left out (with a note); warned: codes; or taken: nothing is said.
    """
    text = cells()
    text = CHANNEL_FAULTS[fault](text, column_of(text, channel))
    try:
        log = _read("\n".join(map(",".join, text)) + "\n")
    except LogError:
        return "refused"
    found = check(log)
    if not next(v.usable for v in found.verdicts if v.purpose == "fit"):
        return "not for a fit"
    codes = sorted({one.code for one in found.warnings} - _usual())
    if codes:
        return f"warned: {', '.join(f'`{code}`' for code in codes)}"
    return "left out" if channel not in log.channels else "taken"


def _read(text: str) -> Log:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ramp.csv"
        path.write_text(text)
        return read_log(path)


@cache
def _usual() -> frozenset[str]:
    """Codes of the warnings that the good ramp has."""
    found: Findings = check(_read("\n".join(map(",".join, cells())) + "\n"))
    assert next(v.usable for v in found.verdicts if v.purpose == "fit")
    return frozenset(one.code for one in found.warnings)


def table(head: str, faults: Sequence[str], rows: dict[str, list[str]]) -> str:
    lines = [f"| {head} | {' | '.join(faults)} |", f"|---|{'---|' * len(faults)}"]
    lines += [f"| {name} | {' | '.join(found)} |" for name, found in rows.items()]
    return "\n".join(lines)


def file_rows() -> dict[str, list[str]]:
    return {
        n: [of_file(n, reader, fault) for fault in FILE_FAULTS] for n, reader in READERS.items()
    }


def channel_rows() -> dict[str, list[str]]:
    return {f"`{c}`": [of_channel(c, fault) for fault in CHANNEL_FAULTS] for c in CHANNELS}


def page_part(files: dict[str, list[str]], channels: dict[str, list[str]]) -> str:
    """The two tables as they stand in the page."""
    by_fault = {
        fault: [row[i] for row in channels.values()] for i, fault in enumerate(CHANNEL_FAULTS)
    }
    return "\n\n".join(
        [
            BEGIN,
            table("file", list(FILE_FAULTS), files),
            table("fault", list(channels), by_fault),
            END,
        ]
    )


def main() -> None:
    import os

    bounds(os.environ.__setitem__)
    before, _, rest = PAGE.read_text().partition(BEGIN)
    after = rest.partition(END)[2]
    PAGE.write_text(before + page_part(file_rows(), channel_rows()) + after)


if __name__ == "__main__":
    main()
