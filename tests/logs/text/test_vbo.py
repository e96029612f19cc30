"""Racelogic VBO: written here after the maker's description, read back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.logs.text.vbo import open_vbo
from tests.support.refusals import refusal

HEAD = """File created on 31/07/2006 at 09:55:20

[header]
satellites
time
latitude
longitude
velocity kmh
heading
height
vertical velocity m/s
Brake Pressure
p_rear
yaw

[channel units]
bar
kPa

[comments]
(c) a logger
Log Rate (Hz) : 100.00

[column names]
sats time lat long velocity heading height vert-vel Brake_Pressure p_rear yaw

[data]
"""
START = 16 * 3600 + 22 * 60 + 35.4


def clock(seconds):
    seconds = round(seconds % 86400, 2)
    whole = int(seconds)
    return f"{whole // 3600:02d}{whole // 60 % 60:02d}{seconds - whole // 60 * 60:05.2f}"


def row(i, start=START, blank=" "):
    cells = [
        *("137", clock(start + i / 100), "+03119.09973", "+00058.49277", f"{36 + i / 10:07.3f}"),
        *("321.85", "+00152.58", "+000.000", f"{i * 1.25:+.6E}", f"{i * 2:+.6E}", "-1.0E+00"),
    ]
    return blank.join(cells)


def vbo(start=START, rows=60, end="\r\n", blank=" ", tail=""):
    body = "".join(row(i, start, blank) + tail + end for i in range(rows))
    return (HEAD.replace("\n", end) + body).encode()


@pytest.mark.parametrize(
    "data",
    [vbo(), vbo(end="\n"), vbo(blank="  "), vbo(blank="\t"), vbo(tail=" "),
     vbo().replace(b"(c)", b"\xa9"), b"\xef\xbb\xbf" + vbo()],
    ids=["Windows", "Unix", "two blanks", "tabs", "blank at the end", "Latin-1", "UTF-8 mark"],
)  # fmt: skip
def test_names_units_and_values(data):
    source = open_vbo(data, "run.vbo")
    index = {c.name: i for i, c in enumerate(source.columns)}
    units = {"time": "s", "v": "kmh", "vertical velocity": "m/s", "Brake Pressure": "bar",
             "p_rear": "kPa", "yaw": None}  # fmt: skip
    assert {name: source.columns[index[name]].unit for name in units} == units
    assert source.columns[index["Brake Pressure"]].full == "Brake_Pressure"
    time, v, p = source.read([index[name] for name in ("time", "v", "Brake Pressure")])
    np.testing.assert_allclose(time, START + np.arange(60) / 100, rtol=0, atol=1e-6)
    np.testing.assert_allclose(v, 36 + np.arange(60) / 10)
    np.testing.assert_allclose(p, np.arange(60) * 1.25)


@given(start=st.integers(0, 8639999))
def test_time_of_day_runs_on_past_midnight(start):
    start = start / 100
    source = open_vbo(vbo(start), "run.vbo")
    (time,) = source.read([1])
    np.testing.assert_allclose(time, start + np.arange(60) / 100, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        *((vbo()[:-cut], "cut off") for cut in (3, 9, 20, 60)),
        (HEAD[:200].encode(), "[data]"),
        (b"", ""),
        (b"time [s],p_mc [bar]\n0,0\n", ""),
        (HEAD.encode(), "no samples"),
        (vbo().replace(b"p_rear yaw", b"p_rear"), "11 names in [header], 10"),
        (vbo().replace(b" 162235.40 ", b" 166035.40 "), "row 1: 166035.4"),
        (vbo().replace(b"[header]", b"[heading]"), "[header]"),
    ],
)
def test_what_is_no_vbo(data, says):
    assert says in refusal(
        lambda: open_vbo(data, "run.vbo").read(range(5)), kind=LogError, names="run.vbo"
    )


def with_units(header, units):
    """A file of time, velocity and the channels of ``header``, with these lines as units."""
    words = " ".join(f"c{i}" for i, _ in enumerate(header))
    text = "[header]\ntime\nvelocity kmh\n" + "".join(f"{name}\n" for name in header)
    text += "\n[channel units]\n" + "".join(f"{unit}\n" for unit in units)
    text += f"\n[column names]\ntime velocity {words}\n\n[data]\n"
    cells = " ".join("+1.0E+00" for _ in header)
    source = open_vbo((text + f"120000.00 036.0 {cells}\n" * 60).encode(), "run.vbo")
    return [c.unit for c in source.columns[2:]], source.notes


@pytest.mark.parametrize(
    ("header", "units", "expected"),
    [
        (["lap"], ["(null)"], [None]),
        (["Brake", "lap"], ["bar", ""], ["bar", None]),
        # a converter of racing logs: the unit of the first is in its name, and has no line
        (["yaw rate deg/s", "Slip", "Brake"], ["deg", "bar", "", ""], ["deg/s", "deg", "bar"]),
        (["yaw rate deg/s", "Brake"], ["deg/s", "bar"], ["deg/s", "bar"]),
        (["Brake", "yaw rate deg/s"], ["bar"], ["bar", "deg/s"]),
        (["yaw rate deg/s"], [], ["deg/s"]),
    ],
)
def test_a_unit_for_each_channel_that_needs_one(header, units, expected):
    assert with_units(header, units) == (expected, ())


def test_units_of_the_module_channels_only():
    """The maker: the section "lists the units of any input module channels", which come last."""
    header = ["Lateral position", "Kalman status", "Satellite mode", "p_front", "p_rear"]
    assert with_units(header, ["bar", "kPa"])[0] == [None, None, None, "bar", "kPa"]
