"""Each kind of file and each channel against each fault, and the page of results with it all."""

import pytest

from calib.base.names import CHANNELS as QUANTITIES
from tests.support.bad_input import (
    BEGIN,
    CHANNEL_FAULTS,
    CHANNELS,
    END,
    FILE_FAULTS,
    PAGE,
    bounds,
    of_channel,
    of_file,
)
from tests.support.fuzzed import READERS

STILL_GOOD = {("dbc", "truncated"), ("sym", "truncated")}
"""What is left of them is a whole file that describes less: neither format has an end."""

UNUSABLE = ("missing", "empty", "truncated", "wrong type", "NaN", "infinite", "out of range")
UNUSABLE_TOO = ("wrong quantity", "wrong sign", "duplicated", "constant", "huge", "hostile")


def written() -> dict[tuple[str, str], str]:
    """The cells of both tables of the page, by row and column."""
    part = PAGE.read_text().partition(BEGIN)[2].partition(END)[0]
    cells: dict[tuple[str, str], str] = {}
    for block in part.strip().split("\n\n"):
        head, _, *rows = [
            [c.strip() for c in row.strip("|").split("|")] for row in block.split("\n")
        ]
        for name, *row in rows:
            cells |= {(name, column): cell for column, cell in zip(head[1:], row, strict=True)}
    return cells


def test_the_page_has_every_cell_and_no_other():
    files = {(name, fault) for name in READERS for fault in FILE_FAULTS}
    channels = {(fault, f"`{channel}`") for channel in CHANNELS for fault in CHANNEL_FAULTS}
    assert set(written()) == files | channels


@pytest.mark.parametrize("name", READERS)
def test_a_bad_file_is_refused_as_the_page_says(name, monkeypatch):
    bounds(monkeypatch.setenv)
    for fault in FILE_FAULTS:
        found = of_file(name, READERS[name], fault)
        assert found == ("read" if (name, fault) in STILL_GOOD else "refused"), fault
        assert written()[name, fault] == found, fault


@pytest.mark.parametrize("channel", CHANNELS)
def test_a_bad_channel_is_told_as_the_page_says(channel):
    for fault in CHANNEL_FAULTS:
        found = of_channel(channel, fault)
        assert written()[fault, f"`{channel}`"] == found, fault
        if QUANTITIES[channel].required and fault in (*UNUSABLE, *UNUSABLE_TOO):
            assert found in ("refused", "not for a fit"), fault
        if fault in UNUSABLE:
            assert found != "taken", fault
