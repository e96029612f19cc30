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


@pytest.mark.parametrize(
    ("cell", "name", "unit"),
    [
        ("p_mc [bar]", "p_mc", "bar"),
        ("p_mc[bar]", "p_mc", "bar"),
        ("p_mc (bar)", "p_mc", "bar"),
        ("p_mc(barg)", "p_mc", "barg"),  # ours: refused later by name
        ("Druck (vorn)", "Druck (vorn)", None),
        ("Druck (vorn) (kPa)", "Druck (vorn)", "kPa"),
        ("p_mc_bar", "p_mc", "bar"),
        ("time_s", "time", "s"),
        ("time_ms", "time", "ms"),
        ("a_x_g", "a_x", "g"),
        ("a_x_m_s2", "a_x", "m/s^2"),
        ("v_km_h", "v", "km/h"),
        ("v_ms", "v_ms", None),  # milliseconds, or metres a second?
        ("omega_fl", "omega_fl", None),
        ("omega_fl_rad_s", "omega_fl", "rad/s"),
        ("omega_fl_1_min", "omega_fl", "1/min"),
        ("T_disc_f_degC", "T_disc_f", "degC"),
        ("T_disc_f", "T_disc_f", None),
        ("valve_s", "valve_s", None),
        ("Bremsdruck_HZ_bar", "Bremsdruck_HZ", "bar"),
        ("speed_min", "speed_min", None),
        ("true_Tb_fl [N*m]", "true_Tb_fl", "N*m"),
        ("_bar", "_bar", None),
        ("", "", None),
        ("[bar]", "", "bar"),
        ("p [x] [bar]", "p [x]", "bar"),
        ("p[bar] x", "p[bar] x", None),
    ],
)
def test_name_and_unit(cell, name, unit):
    column = column_from_cell(cell)
    assert (column.name, column.unit) == (name, unit)
    assert cell.strip() in (column.name, column.full, f"{column.name} [{column.unit}]")


@pytest.mark.parametrize(
    ("cells", "units"),
    [
        (["s", "bar", "1", ""], True),
        (["[s]", "(bar)", "V", "-"], True),
        (["0.0", "bar"], False),
        (["0,005", "g"], False),
        (["on", "off"], False),
        (["1", "1"], False),
        (["", ""], False),
    ],
)
def test_row_of_units(cells, units):
    assert is_unit_row(cells) is units


@pytest.mark.parametrize("cell", ["x" + "\t" * 20_000 + "y", "x (" * 20_000, "[" * 20_000])
def test_a_long_cell_takes_no_time(cell):
    """Time that grows with the square of its length would be minutes."""
    assert column_from_cell(cell).unit is None


BEGIN = datetime(2026, 3, 14, 23, 59, 59, 700000, timezone(timedelta(hours=1)))
TIME = np.arange(60) / 100
STAMPS = [BEGIN + timedelta(milliseconds=10 * i) for i in range(60)]
FORMS = {
    "German": lambda x: x.strftime("%H:%M:%S,%f")[:-3],
    "ISO": lambda x: x.isoformat(timespec="milliseconds"),
    "ISO with Z": lambda x: x.strftime("%Y-%m-%dT%H:%M:%S.%fZ"),
    "ISO with a blank": lambda x: x.strftime("%Y-%m-%d %H:%M:%S.%f"),
    "month by name": lambda x: x.strftime("%d-%b-%Y %H:%M:%S.%f")[:-3],
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
    with pytest.raises(LogError, match="row 31"):
        open_csv(table([*cells[:30], "later", *cells[31:]]), "run.csv").read([0])
    empty = open_csv(table([*cells[:30], "", *cells[31:]]), "run.csv").read([0])[0]
    assert np.flatnonzero(np.isnan(empty)).tolist() == [30]
    source = open_csv(table([f"2026-03-{i % 28 + 1:02d}" for i in range(60)]), "run.csv")
    assert source.columns[0].unit is None


@pytest.mark.parametrize("form", ["%H:%M:%S", "%d.%m.%Y %H:%M:%S"])
def test_a_clock_of_whole_seconds_is_refused(form):
    source = open_csv(table(x.strftime(form) for x in STAMPS), "run.csv")
    assert source.read([1])[0].size == 60
    with pytest.raises(LogError, match="58 of 60"):
        source.read([0])


BARE = [x.replace(tzinfo=None) for x in STAMPS]
KINDS = [
    *((BARE, pa.timestamp(unit)) for unit in ("ms", "us", "ns")),
    (STAMPS, pa.timestamp("us", "Europe/Berlin")),
    *(([x.time() for x in BARE], kind) for kind in (pa.time32("ms"), pa.time64("us"))),
    ([x - BEGIN for x in STAMPS], pa.duration("us")),
]


@pytest.mark.parametrize(("values", "kind"), KINDS, ids=lambda one: str(one)[:20])
def test_clocks_in_parquet(values, kind):
    values = [*values[:30], None, *values[31:]]
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table({"when": pa.array(values, kind), "x": TIME}), sink)
    source = open_parquet(sink.getvalue().to_pybytes(), "run.parquet")
    assert source.columns[0].unit == "s"
    (time,) = source.read([0])
    assert np.flatnonzero(np.isnan(time)).tolist() == [30]
    np.testing.assert_allclose(np.delete(time, 30), np.delete(TIME, 30), atol=1e-9)
