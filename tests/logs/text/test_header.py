"""Header cells: what is a unit and what is a part of the name."""

import pytest

from calib.logs.text.cells import bare_unit, column_from_cell, is_unit_row


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


def test_bare_unit():
    assert [bare_unit(c) for c in ("[bar]", "(bar)", " bar ", "[", "")] == ["bar"] * 3 + ["[", ""]


@pytest.mark.parametrize("cell", ["x" + "\t" * 20_000 + "y", "x (" * 20_000, "[" * 20_000])
def test_a_long_cell_takes_no_time(cell):
    """Time that grows with the square of its length would be minutes."""
    assert column_from_cell(cell).unit is None


@pytest.mark.parametrize(
    ("cell", "name", "unit"),
    [("[bar]", "", "bar"), ("p [x] [bar]", "p [x]", "bar"), ("p[bar] x", "p[bar] x", None),
     ("p ]x[ bar]", "p ]x", " bar"), ("p (kPa)", "p", "kPa"), ("p (x)", "p (x)", None)],
)  # fmt: skip
def test_the_last_brackets_have_the_unit(cell, name, unit):
    found = column_from_cell(cell)
    assert (found.name, found.unit) == (name, unit and unit.strip())
