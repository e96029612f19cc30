"""ASC: an end that is missing, a line that cannot be read, clocks that count otherwise."""

import re

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.read import read_log
from tests.support.recordings import write_bus
from tests.support.refusals import refusal


@pytest.fixture(scope="module")
def folder(bus):
    write_bus(bus / "whole.asc")
    return bus


def read(folder, text):
    path = folder / "other.asc"
    path.write_text(text)
    return read_log(path, folder / "map.toml")


def refused(folder, text):
    return refusal(read, folder, text, kind=LogError)


@pytest.fixture(scope="module")
def text(folder):
    return (folder / "whole.asc").read_text()


@pytest.mark.parametrize("share", [0.0005, 0.3333, 0.99999])
def test_a_file_cut_anywhere_is_refused(folder, text, share):
    message = refused(folder, text[: int(share * len(text))])
    assert "cut off" in message or "the end is missing" in message or "no frames" in message


def test_cut_at_the_end_of_a_line(folder, text):
    lines = text.splitlines(keepends=True)
    message = refused(folder, "".join(lines[:2005]))
    frames = sum(bool(re.search(r" (Rx|Tx) ", line)) for line in lines[:2005])
    assert f"{frames} frames up to" in message
    assert "no 'End TriggerBlock'" in message


def test_no_frame_is_lost_to_a_short_header(folder, text):
    """python-can takes the line after `base` for a part of the header."""
    lines = text.splitlines(keepends=True)
    short = [x for x in lines if not re.match("internal|Begin|End|.*Start of", x)]
    whole, log = read(folder, text), read(folder, "".join(short))
    np.testing.assert_array_equal(whole["omega_fl"], log["omega_fl"])


def test_a_frame_with_too_little_data(folder, text):
    lines = text.splitlines(keepends=True)
    classic = next(i for i, x in enumerate(lines) if " d 8 " in x)
    lines[classic] = lines[classic].rstrip()[:-3] + "\n"
    assert "7 of 8 bytes" in refused(folder, "".join(lines))


def test_a_length_code_past_8_stands_for_8_bytes(folder, text):
    """ISO 11898-1; CANalyzer writes such frames as they were sent."""
    found = re.search(r"(?m)^.* 100 .*(Rx|Tx) +d 8 .*$", text)[0]
    whole, coded = (
        read(folder, text),
        read(folder, text.replace(found, found.replace("d 8", "d D"))),
    )
    np.testing.assert_array_equal(coded["omega_fl"], whole["omega_fl"])


def test_a_classic_frame_of_more_than_8_bytes(folder, text):
    found = re.search(r"(?m)^.* 100 .*(Rx|Tx) +d 8 .*$", text)[0]
    longer = found.replace("d 8", "d 10") + " 00 00 00 00 00 00 00 00"
    refused(folder, text.replace(found, longer))


def test_a_line_that_is_damaged(folder, text):
    lines = text.splitlines(keepends=True)
    classic = [i for i, x in enumerate(lines) if " d 8 " in x][30]
    lines[classic] = lines[classic][:-3] + "G\n"
    assert "not readable after frame" in refused(folder, "".join(lines))


def test_times_since_the_line_before(folder, text):
    relative = text.replace("timestamps absolute", "timestamps relative")
    assert "relative to the line before" in refused(folder, relative)
