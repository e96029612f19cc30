"""ASC: an end that is missing, a line that cannot be read, clocks that count otherwise."""

import re

import numpy as np
import pytest


@pytest.fixture(scope="module")
def text(bus_folder):
    return (bus_folder / "whole.asc").read_text()


@pytest.fixture(scope="module")
def classic(text):
    """The line of a classic frame that the DBC describes."""
    return re.search(r"(?m)^.* 100 .*(Rx|Tx) +d 8 .*$", text)[0]


@pytest.mark.parametrize("share", [0.0005, 0.3333, 0.99999])
def test_a_file_cut_anywhere_is_refused(refused_bus, text, share):
    refused_bus("other.asc", text[: int(share * len(text))])


def test_cut_at_the_end_of_a_line(refused_bus, text):
    lines = text.splitlines(keepends=True)[:2005]
    frames = sum(bool(re.search(r" (Rx|Tx) ", line)) for line in lines)
    assert f"{frames} frames up to" in refused_bus("other.asc", "".join(lines))


def without_header(text, _):
    """python-can takes the line after `base` for a part of the header."""
    return re.sub(r"(?m)^(internal|Begin|End|.*Start of).*\n", "", text)


def length_past_8(text, frame):
    """It stands for 8 bytes (ISO 11898-1); CANalyzer writes such frames as they were sent."""
    return text.replace(frame, frame.replace("d 8", "d D"))


@pytest.mark.parametrize("change", [without_header, length_past_8])
def test_what_loses_no_frame(read_bus, text, classic, change):
    whole, log = read_bus("other.asc", text), read_bus("other.asc", change(text, classic))
    np.testing.assert_array_equal(log["omega_fl"], whole["omega_fl"])


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (r"( d 8 .*) \w\w$", r"\1", "7 of 8 bytes"),
        (r" d 8 (.*)$", r" d 10 \1" + 8 * " 00", ""),
        (r"( d 8 .*)\w\w$", r"\1xG", "after frame"),
        ("timestamps absolute", "timestamps relative", "relative"),
    ],
)
def test_what_is_no_frame_or_no_clock(refused_bus, text, old, new, says):
    damaged, count = re.subn(f"(?m){old}", new, text, count=1)
    assert count == 1
    assert says in refused_bus("other.asc", damaged)
