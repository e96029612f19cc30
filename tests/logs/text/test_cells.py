"""Header cells, and times of day as text."""

from datetime import datetime, timedelta, timezone

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.base.errors import LogError
from calib.logs.parquet import open_parquet
from calib.logs.text.cells import column_from_cell, is_unit_row
from calib.logs.text.csv import open_csv

CELLS = {
    "p_mc [bar]": ("p_mc", "bar"),
    "p_mc(barg)": ("p_mc", "barg"),  # ours: refused later by name
    "Druck (vorn)": ("Druck (vorn)", None),
    "Druck (vorn) (kPa)": ("Druck (vorn)", "kPa"),
    "time_ms": ("time", "ms"),
    "a_x_m_s2": ("a_x", "m/s^2"),
    "v_ms": ("v_ms", None),  # milliseconds, or metres a second?
    "omega_fl": ("omega_fl", None),
    "omega_fl_1_min": ("omega_fl", "1/min"),
    "T_disc_f_degC": ("T_disc_f", "degC"),
    "valve_s": ("valve_s", None),
    "GPS_speed_knots": ("GPS_speed", "kn"),
    "T_min": ("T_min", None),  # the lowest one
    "Bremsdruck_HZ_bar": ("Bremsdruck_HZ", "bar"),
    "_bar": ("_bar", None),
    "": ("", None),
    "[bar]": ("", "bar"),
    "p[bar] x": ("p[bar] x", None),
}


@pytest.mark.parametrize("cell", CELLS)
def test_name_and_unit(cell):
    column = column_from_cell(cell)
    assert (column.name, column.unit) == CELLS[cell]
    assert cell.strip() in (column.name, column.full, f"{column.name} [{column.unit}]")


def test_row_of_units():
    rows = [["s", "bar", "1", ""], ["[s]", "(bar)", "V", "-"], ["0.0", "bar"], ["0,005", "g"]]
    rows += [["on", "off"], ["1", "1"], ["", ""]]
    assert [is_unit_row(row) for row in rows] == [True, True, *[False] * 5]


BEGIN = datetime(2026, 3, 14, 23, 59, 59, 700000, timezone(timedelta(hours=1)))
TIME = np.arange(60) / 100
STAMPS = [BEGIN + timedelta(milliseconds=10 * i) for i in range(60)]
FORMS = {
    "German": lambda x: x.strftime("%H:%M:%S,%f")[:-3],
    "ISO": lambda x: x.isoformat(timespec="milliseconds"),
    "ISO with Z": lambda x: x.strftime("%Y-%m-%dT%H:%M:%S.%fZ"),
    "day.month.year": lambda x: x.strftime("%d.%m.%Y %H:%M:%S.%f")[:-4],
    "half a day": lambda x: x.strftime("%m/%d/%Y %I:%M:%S.%f %p"),
    "weekday": lambda x: x.strftime("%a %b %d %H:%M:%S.%f GMT+01:00 %Y"),
    "minutes": lambda x: x.strftime("%M:%S.%f")[:-3],
    "colons": lambda x: x.strftime("%H:%M:%S:%f")[:-3],
    "no leading zero": lambda x: f"{x.hour}:{x.minute}:{x.second + x.microsecond / 1e6:.2f}",
}


def table(cells):
    rows = "".join(f"{cell};{i},5;{i}\n" for i, cell in enumerate(cells))
    return ("Uhrzeit;Druck [bar];v [km/h]\n" + rows).encode()


@pytest.mark.parametrize("form", FORMS)
def test_seconds_from_the_first_row_past_midnight(form):
    source = open_csv(table(map(FORMS[form], STAMPS)), "run.csv")
    assert source.columns[0].unit == "s"
    np.testing.assert_allclose(source.read([0])[0], TIME, atol=1e-9)


def test_what_is_no_clock_time():
    cells = [FORMS["ISO"](x) for x in STAMPS]
    empty = open_csv(table([*cells[:30], "", *cells[31:]]), "run.csv").read([0])[0]
    assert np.flatnonzero(np.isnan(empty)).tolist() == [30]
    source = open_csv(table([f"2026-03-{i % 28 + 1:02d}" for i in range(60)]), "run.csv")
    assert source.columns[0].unit is None
    whole_seconds = [x.strftime("%d.%m.%Y %H:%M:%S") for x in STAMPS]
    for bad, says in (([*cells[:30], "later", *cells[31:]], "row 31"), (whole_seconds, "58 of 60")):
        with pytest.raises(LogError, match=says):
            open_csv(table(bad), "run.csv").read([0])


BARE = [x.replace(tzinfo=None) for x in STAMPS]
KINDS = [
    *((BARE, pa.timestamp(unit)) for unit in ("ms", "us", "ns")),
    (STAMPS, pa.timestamp("us", "Europe/Berlin")),
    *(([x.time() for x in BARE], kind) for kind in (pa.time32("ms"), pa.time64("us"))),
    ([x - BEGIN for x in STAMPS], pa.duration("us")),
]


@pytest.mark.parametrize(("values", "kind"), KINDS, ids=lambda x: str(x)[:20])
def test_clocks_in_parquet(values, kind):
    values = [*values[:30], None, *values[31:]]
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table({"when": pa.array(values, kind), "x": TIME}), sink)
    source = open_parquet(sink.getvalue().to_pybytes(), "run.parquet")
    assert source.columns[0].unit == "s"
    (time,) = source.read([0])
    assert np.flatnonzero(np.isnan(time)).tolist() == [30]
    np.testing.assert_allclose(np.delete(time, 30), np.delete(TIME, 30), atol=1e-9)
