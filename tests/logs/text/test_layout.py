"""The header of a text table below lines of other kinds, and what tells its columns apart."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.channel_map import ChannelMap, Mapping, assign
from calib.logs.source import Column
from calib.logs.text.csv import open_csv
from tests.support.refusals import refusal

NAMES, UNITS = "Time,Brake,v", "s,bar,km/h"
ROWS = "".join(f"{i / 100:.2f},{i / 10:.1f},{90 - i / 8:.3f}\n" for i in range(60))
ABOVE = {
    "key and value": '"Format","A File"\n"Sample Rate","100","Hz",,\n"Beacons","1.5","3.2"\n\n',
    "comments": "# logger 5, 100 Hz\n# a, b, c, d\n",
    "a title": "This file is made by X ( http://x ).\nNote,\n\n",
    "as wide as the table": "Format,3,\nCreated,14/03/2026,10:00\n\n",
    "nothing": "",
}
HEADERS = {
    "units": f"{NAMES}\n{UNITS}\n",
    "blanks": f"{NAMES}\n{UNITS}\n\n\n",
    "a blank between": f"{NAMES}\n\n{UNITS}\n\n",
    "quotes": '"Time","Brake","v"\n"s","bar","km/h"\n',
    "sources": f"{NAMES}\n{UNITS}\n,bus 1,gps\n",
    "one row": "Time [s],Brake [bar],v [km/h]\n",
    "bars": '"Time"|"s"|0|0|1,"Brake"|"bar"|0|200|100,"v"|"km/h"|0|300|25\n',
}


@pytest.mark.parametrize("header", HEADERS)
@pytest.mark.parametrize(
    ("above", "row_end"), [*((above, "") for above in ABOVE), ("nothing", ",")]
)
def test_the_header_is_what_stands_over_the_numbers(above, header, row_end):
    text = ABOVE[above] + HEADERS[header] + ROWS.replace("\n", f"{row_end}\n")
    source = open_csv(text.encode(), "run.csv")
    names_and_units = [(c.name, c.unit) for c in source.columns]
    expected = [("Time", "s"), ("Brake", "bar"), ("v", "km/h")]
    assert names_and_units == expected + [("", None)] * len(row_end)
    time, brake, _ = source.read(range(3))
    np.testing.assert_allclose(time, np.arange(60) / 100)
    np.testing.assert_allclose(brake, np.arange(60) / 10)


def test_what_tells_columns_of_one_name_apart():
    """A row below the units, or the unit."""
    below = open_csv(("time,v,v\ns,m/s,m/s\n,gps,calc\n" + ROWS).encode(), "run.csv").columns
    assert [column.full for column in below[1:]] == ["v gps", "v calc"]
    units = (Column("v", "m/s"), Column("v", "km/h"))
    cases = ((below, "v calc", 2), (units, "v [m/s]", 0), (units, "v [km/h]", 1))
    for columns, cell, index in cases:
        assigned, _, _ = assign(columns, ChannelMap("map", {"v": Mapping(cell)}), ("v",), "run.csv")
        assert next(item.index for item in assigned if item.channel == "v") == index
    with pytest.raises(LogError):
        assign(units, ChannelMap("map", {"v": Mapping("v")}), ("v",), "run.csv")


def test_zero_bytes_at_the_end_and_old_line_ends():
    text = (HEADERS["units"] + ROWS).encode()
    source = open_csv(text + bytes(100), "run.csv")
    assert "100 zero bytes" in source.notes[0]
    for data in (text + bytes(100), text.replace(b"\n", b"\r")):
        assert open_csv(data, "run.csv").read([0])[0].size == 60
    with pytest.raises(LogError, match="cut off"):
        open_csv(text[:-3] + bytes(100), "run.csv")


TWO = "time [s],p_mc [bar]\n"
SAMPLES = "".join(f"{i / 200:.3f},{i / 10:.2f}\n" for i in range(60))


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"MDF     \0\0\0\0", "not text"),
        ((TWO + SAMPLES.replace("0.015,0.30", "0.015,open")).encode(), "row 4: 'open'"),
        ((TWO + SAMPLES.replace("0.015,", "0.015,7,")).encode(), "row 4 has 3 cells"),
        (b"time;p_mc\ns;bar\n", ""),
        (b"sep=;\n", "no samples"),
    ],
)
def test_what_is_no_table(data, says):
    assert says in refusal(lambda: open_csv(data, "run.csv").read([0, 1]), kind=LogError)
