"""Each kind of file and each channel against each fault, and the page of results with it all."""

import random
from collections.abc import Callable
from functools import cache

import numpy as np
import pandas as pd
import pytest

from calib.base import bounded
from calib.base.errors import BrakeCalError, LogError
from calib.base.names import CHANNELS as QUANTITIES
from calib.logs.read import read_log
from calib.plausibility.check import check
from calib.store.journal import Journal
from calib.store.snapshot import Snapshot
from tests.support.fuzzed import READERS, ROOT, SEDAN

PAGE = ROOT / "tests" / "studies" / "results" / "bad_input.md"
LARGE = 2_000_000
PICTURE = (ROOT / "sample_logs" / "figures" / "table.png").read_bytes()[:20_000]

FILE_FAULTS: dict[str, Callable[[bytes], bytes | None]] = {
    "missing": lambda good: None,
    "empty": lambda good: b"",
    "truncated": lambda good: good[: len(good) // 2],
    "wrong type": lambda good: PICTURE,
    "huge": lambda good: good + b"\n" * LARGE,
    "hostile": lambda good: random.Random(5).randbytes(4000),
    "nested": lambda good: b"x = " + b"[" * 100_000,
}
STILL_GOOD = {("dbc", "truncated"), ("sym", "truncated")}
"""What is left of them is a whole file that describes less: neither format has an end."""

Change = Callable[[pd.DataFrame, str], pd.DataFrame]
"""What becomes of a run when a fault meets a column."""


def put(value: object, rows: slice) -> Change:
    def change(run: pd.DataFrame, name: str) -> pd.DataFrame:
        column = run[name].astype(object)
        column.iloc[rows] = value
        return run.assign(**{name: column})

    return change


def mapped(function: Callable[[pd.Series], object]) -> Change:
    return lambda run, name: run.assign(**{name: function(run[name])})


def of_unit(units: Callable[[str], str]) -> Change:
    def change(run: pd.DataFrame, name: str) -> pd.DataFrame:
        bare, _, unit = name.rstrip("]").partition(" [")
        return run.rename(columns={name: f"{bare} [{units(unit)}]"})

    return change


OTHER_UNIT = {"s": "ms", "bar": "kPa", "m/s^2": "g", "rad/s": "rpm", "m/s": "km/h", "deg": "rad"}
"""Another unit of the same quantity, which a header may claim wrongly."""

CHANNELS = ("time", "p_mc", "a_x", "omega_fl", "omega_rl", "v", "p_fl", "steering", "T_drive_f")
CHANNEL_FAULTS: dict[str, Change] = {
    "missing": lambda run, name: run.drop(columns=name),
    "empty": put("", slice(None)),
    "truncated": put("", slice(-300, None)),
    "wrong type": put("high", slice(40, 41)),
    "NaN": put("NaN", slice(40, 140)),
    "infinite": put("inf", slice(40, 41)),
    "out of range": put("1e9", slice(40, 41)),
    "wrong unit": of_unit(lambda unit: OTHER_UNIT.get(unit, "kN*m")),
    "wrong quantity": of_unit(lambda unit: "kg"),
    "wrong sign": mapped(lambda x: -x),
    "shifted": mapped(lambda x: x.shift(100).fillna(x.iloc[0])),
    "duplicated": lambda run, name: pd.concat([run, run[name]], axis=1),
    "constant": mapped(lambda x: 1.0),
    "huge": mapped(lambda x: x * 1e300),
    "hostile": put("\x1b[2J\u202e", slice(40, 41)),
}
UNUSABLE = ("missing", "empty", "truncated", "wrong type", "NaN", "infinite", "out of range")
UNUSABLE_TOO = ("wrong quantity", "wrong sign", "duplicated", "constant", "huge", "hostile")


@cache
def written() -> dict[tuple[str, str], str]:
    """The cells of both tables of the page, by row and column."""
    cells: dict[tuple[str, str], str] = {}
    for block in PAGE.read_text().split("\n\n"):
        if block.startswith("| "):
            head, _, *rows = (
                [c.strip() for c in row.strip("|").split("|")] for row in block.strip().split("\n")
            )
            for name, *row in rows:
                cells |= {(name, column): cell for column, cell in zip(head[1:], row, strict=True)}
    return cells


def test_the_page_has_every_cell_and_no_other():
    files = {(name, fault) for name in READERS for fault in FILE_FAULTS}
    channels = {(fault, f"`{channel}`") for channel in CHANNELS for fault in CHANNEL_FAULTS}
    assert set(written()) == files | channels


@pytest.mark.parametrize("name", READERS)
def test_a_bad_file_is_refused_as_the_page_says(name, tmp_path, monkeypatch):
    kinds = [kind for kind in vars(bounded).values() if isinstance(kind, bounded.FileKind)]
    for kind in kinds:  # what is huge here exceeds each bound
        monkeypatch.setenv(kind.variable, str(min(kind.megabytes, LARGE / 2e6)))
    reader = READERS[name]
    good = reader.seeds()[0]
    for fault, spoil in FILE_FAULTS.items():
        folder = tmp_path / fault
        folder.mkdir()
        if (data := spoil(good)) is not None:
            (folder / reader.file).write_bytes(data)
        try:
            read = reader.read(folder / reader.file)
            found = "empty" if read == Snapshot(folder, Journal()) else "read"
        except BrakeCalError:
            found = "refused"
        assert found == ("read" if (name, fault) in STILL_GOOD else "refused"), fault
        assert written()[name, fault] == found, fault


@pytest.fixture(scope="module")
def run() -> pd.DataFrame:
    """The ramp with the optional channels beside."""
    run = pd.read_csv(SEDAN / "ramp_wet_asphalt.csv")
    chance, n = np.random.default_rng(3), len(run)
    steering = chance.normal(0.0, 0.2, n).round(3)
    drive = chance.normal(-30.0, 1.0, n).round(2)
    wheel = (run["p_mc [bar]"] + chance.normal(0, 0.1, n)).round(2)
    more = {"p_fl [bar]": wheel, "p_fr [bar]": wheel + 0.05, "steering [deg]": steering}
    return run.assign(**more, **{"T_drive_f [N*m]": drive})


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """What the program says of a run: refused, no fit, or codes of warnings and channels taken."""
    path = tmp_path_factory.mktemp("told") / "ramp.csv"

    def of(run: pd.DataFrame):
        run.to_csv(path, index=False, float_format="%.6g")
        try:
            log = read_log(path)
        except LogError:
            return "refused", set(), set()
        found = check(log)
        fits = next(v.usable for v in found.verdicts if v.purpose == "fit")
        return "" if fits else "not for a fit", {w.code for w in found.warnings}, set(log.channels)

    return of


@pytest.fixture(scope="module")
def usual(run, told):
    """Codes of the warnings that the good ramp has."""
    found, codes, _ = told(run)
    assert found == ""
    return codes


@pytest.mark.parametrize("channel", CHANNELS)
def test_a_bad_channel_is_told_as_the_page_says(run, told, usual, channel):
    column = next(name for name in run if name.split(" ")[0] == channel)
    for fault, change in CHANNEL_FAULTS.items():
        found, codes, taken = told(change(run, column))
        if not found and (new := sorted(codes - usual)):
            found = f"warned: {', '.join(f'`{code}`' for code in new)}"
        found = found or ("taken" if channel in taken else "left out")
        assert written()[fault, f"`{channel}`"] == found, fault
        if QUANTITIES[channel].required and fault in (*UNUSABLE, *UNUSABLE_TOO):
            assert found in ("refused", "not for a fit"), fault
        if fault in UNUSABLE:
            assert found != "taken", fault
