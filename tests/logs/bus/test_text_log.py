"""Lines are counted as they pass, and a last one without an end is seen."""

import io
import re
from pathlib import Path

import pytest

from calib.errors import LogError
from calib.logs.bus.dbc import Dbc
from calib.logs.bus.frames import Gathered
from calib.logs.bus.text_logs import Counted

NOTHING = Dbc({}, ())


def counted(text):
    return Counted(io.StringIO(text), re.compile("frame"), Path("run.log"))


def test_lines_that_look_like_frames_are_counted():
    lines = counted("head\nframe 1\nframe 2\n\n")
    assert list(lines) == ["head\n", "frame 1\n", "frame 2\n", "\n"]
    assert (lines.frames, lines.last) == (2, "frame 2\n")


def test_a_frame_that_the_library_passed_over_is_missed():
    lines = counted("frame 1\nframe 2\n")
    list(lines)
    found = Gathered(lambda *_: False)
    found.times.append(0.0)
    with pytest.raises(LogError, match="1 of 2 lines that look like frames can be read: 1 are"):
        lines.require_all(found)
    found.times.append(1.0)
    lines.require_all(found)


@pytest.mark.parametrize(("end", "whole"), [("frame 2", 1), ("fra", 1), ("frame 2\nfr", 2)])
def test_whole_frames_before_a_line_without_end(end, whole):
    lines = counted("frame 1\n" + end)
    with pytest.raises(LogError, match=f"cut off within the last line, after {whole} whole"):
        lines.gathered(iter(list(lines)[:0]), NOTHING)
