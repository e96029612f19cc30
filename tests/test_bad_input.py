"""Bad input in the library: what is damaged or mutated is read, or refused by our own errors.

Damaged files at the command line are in `tests/cli/test_hostile.py`.
"""

import random
import struct
import warnings
from collections.abc import Callable

import pandas as pd
import pytest

from calib.base import bounded
from calib.base.errors import BrakeCalError, LogError
from calib.logs.read import read_log
from calib.plausibility.check import check
from calib.store.journal import Journal
from calib.store.snapshot import Snapshot
from tests.support.readers import READERS, SEDAN

EXECUTIONS = 20
LARGE = 2_000_000
NO_LOG_OR_RESULT = {("parquet", 1), ("result", 0), ("result", 1)}

DAMAGES: dict[str, Callable[[bytes], bytes | None]] = {
    "missing": lambda good: None,
    "empty": lambda good: b"",
    "cut in half": lambda good: good[: len(good) // 2],
    "bytes": lambda good: b"\x89PNG" + random.Random(5).randbytes(4000),
    "huge": lambda good: good + b"\n" * LARGE,
    "nested": lambda good: b"x = " + b"[" * 100_000,
}
STILL_WHOLE = {("dbc", "cut in half"), ("sym", "cut in half")}
"""Kinds of file whose first half is a whole file that describes less."""


@pytest.mark.parametrize("name", READERS)
def test_a_good_file_is_read_and_a_damaged_one_refused(name, tmp_path, monkeypatch):
    reader = READERS[name]
    seeds = reader.seeds()
    for number, data in enumerate(seeds):
        if (name, number) not in NO_LOG_OR_RESULT:
            (tmp_path / reader.file).write_bytes(data)
            reader.read(tmp_path / reader.file)
    for kind in (kind for kind in vars(bounded).values() if isinstance(kind, bounded.FileKind)):
        monkeypatch.setenv(kind.variable, str(min(kind.megabytes, LARGE / 2e6)))
    for damage, spoil in DAMAGES.items():
        folder = tmp_path / damage
        folder.mkdir()
        spoilt = spoil(seeds[0])
        if spoilt is not None:
            (folder / reader.file).write_bytes(spoilt)
        try:
            refused = reader.read(folder / reader.file) == Snapshot(folder, Journal())
        except BrakeCalError:
            refused = True
        assert refused == ((name, damage) not in STILL_WHOLE), damage


WORDS = (
    b"\0", b"\xff" * 4, b"\n", b'"', b"nan", b"inf", b"-1", b"1e999", b"9" * 400, b"[" * 400,
    b"{", b"\x1b[2J", b"\xe2\x80\xae", b"\xef\xbb\xbf", b";", b",", b"=", b"&a;", b"\\u0000",
)  # fmt: skip
NUMBERS = (0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF, 2**64 - 1)


def mutated(seeds: list[bytes], chance: random.Random) -> bytes:
    """A seed with one to six changes: bits, bytes, words, numbers, parts cut, moved, doubled."""
    data = bytearray(chance.choice(seeds))
    for _ in range(chance.randint(1, 6)):
        start = chance.randrange(len(data) + 1)
        end = min(len(data), start + int(chance.paretovariate(0.7)))
        match chance.randrange(8):
            case 0 if start < len(data):
                data[start] ^= 1 << chance.randrange(8)
            case 1 if start < len(data):
                data[start] = chance.randrange(256)
            case 2:
                del data[start:end]
            case 3:
                data[start:start] = data[start:end]
            case 4:
                data[start:start] = chance.choice(WORDS)
            case 5:
                word = chance.choice(WORDS)
                data[start : start + len(word)] = word
            case 6:
                kind = chance.choice("BHIQ")
                size = struct.calcsize(kind)
                number = chance.choice(NUMBERS) % 256**size
                data[start : start + size] = struct.pack(f"<{kind}", number)
            case 7 if chance.random() < 0.3:
                del data[start:]
    return bytes(data)


@pytest.mark.parametrize("name", READERS)
def test_mutated_files_are_read_or_refused(name, tmp_path):
    reader, chance = READERS[name], random.Random(20)
    seeds, path = reader.seeds(), tmp_path / reader.file
    for _ in range(EXECUTIONS):
        data = mutated(seeds, chance)
        path.write_bytes(data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of asammdf and python-can on damaged files
            try:
                reader.read(path)
            except BrakeCalError:
                pass
            except Exception as error:
                pytest.fail(f"{error!r} of {data[:200]!r}")


def put(value: object, rows: slice) -> Callable[[pd.Series], pd.Series]:
    def change(column: pd.Series) -> pd.Series:
        column = column.astype(object)
        column.iloc[rows] = value
        return column

    return change


UNITS = {"s": "ms", "bar": "kPa", "m/s^2": "g", "rad/s": "rpm", "m/s": "km/h"}
CHANNELS = {"time": "s", "p_mc": "bar", "a_x": "m/s^2", "omega_fl": "rad/s", "v": "m/s"}
FAULTS = {
    "empty": put("", slice(None)),
    "truncated": put("", slice(-300, None)),
    "wrong type": put("high", slice(40, 41)),
    "NaN": put("NaN", slice(40, 140)),
    "infinite": put("inf", slice(40, 41)),
    "out of range": put("1e9", slice(40, 41)),
    "wrong sign": lambda x: -x,
    "constant": lambda x: 0.0 * x + 1.0,
    "huge": lambda x: x * 1e300,
    "hostile": put("\x1b[2J\u202e", slice(40, 41)),
}


@pytest.mark.parametrize("channel", CHANNELS)
def test_a_bad_channel_is_not_taken(channel, tmp_path):
    """The optional speed v is left out, or the log is not usable for a fit."""
    run = pd.read_csv(SEDAN / "ramp_wet_asphalt.csv")
    unit = CHANNELS[channel]
    column = f"{channel} [{unit}]"
    spoilt = {kind: run.assign(**{column: change(run[column])}) for kind, change in FAULTS.items()}
    spoilt |= {
        "missing": run.drop(columns=column),
        "twice": pd.concat([run, run[column]], axis=1),
        "wrong unit": run.rename(columns={column: f"{channel} [{UNITS[unit]}]"}),
        "wrong quantity": run.rename(columns={column: f"{channel} [kg]"}),
    }
    for fault, frame in spoilt.items():
        frame.to_csv(tmp_path / "ramp.csv", index=False)
        try:
            log = read_log(tmp_path / "ramp.csv")
        except LogError:
            continue
        fits = next(x.usable for x in check(log).verdicts if x.purpose == "fit")
        assert not fits or (channel == "v" and "v" not in log.channels), fault
