"""Channel maps: foreign names, units and signs."""

from pathlib import Path

import pytest

from calib.base.errors import ChannelMapError, LogError
from calib.logs.channel_map import DatabaseFile
from calib.logs.channel_map_file import read_channel_map
from calib.logs.read import read_log
from tests.support.refusals import refusal

HEADER = "Zeit [ms],Brake pressure,Decel [g],FL [rpm],FR [rpm],RL [rpm],RR [rpm],p_mc [bar]"
ROW = "{},{},0.5,60,60,60,60,999"
MAP = """schema = 1
[channels.time]
source = "Zeit"
[channels.p_mc]
source = "Brake pressure"
unit = "kPa"
scale = 2.0
offset = -10.0
[channels.a_x]
source = "Decel"
sign = -1
"""
MAP += "".join(
    f'[channels.omega_{wheel}]\nsource = "{wheel.upper()}"\n' for wheel in ("fl", "fr", "rl", "rr")
)


@pytest.fixture
def log_file(tmp_path):
    path = tmp_path / "run.csv"
    rows = [ROW.format(5 * i, 10 + i) for i in range(60)]
    path.write_text("\n".join([HEADER, *rows, ""]))
    return path


def write_map(tmp_path, text):
    path = tmp_path / "map.toml"
    path.write_text(text)
    return path


def refused(path):
    return refusal(read_channel_map, path, kind=ChannelMapError, names=path)


def test_names_units_signs_scale_and_offset(tmp_path, log_file):
    log = read_log(log_file, write_map(tmp_path, MAP))
    assert log.time[1] == pytest.approx(0.005)
    assert log["p_mc"][0] == pytest.approx((2 * 10 - 10) * 1e3)
    assert log["p_mc"][1] == pytest.approx((2 * 11 - 10) * 1e3)
    assert log["a_x"][0] == pytest.approx(-0.5 * 9.80665)
    assert log["omega_fl"][0] == pytest.approx(2 * 3.141592653589793)
    assert log.ignored == ("p_mc",)  # hidden by the map


def test_source_that_the_log_does_not_have(tmp_path, log_file):
    path = write_map(tmp_path, MAP.replace('"Decel"', '"Deccel"'))
    with pytest.raises(ChannelMapError, match=r"no column 'Deccel' for a_x.*is 'Decel' meant"):
        read_log(log_file, path)


def test_source_that_is_there_twice(tmp_path, log_file):
    log_file.write_text(log_file.read_text().replace("p_mc [bar]", "Decel [g]"))
    with pytest.raises(LogError, match="2 columns are called 'Decel'"):
        read_log(log_file, write_map(tmp_path, MAP))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[channels.a_x]", "[channels.ax]", ("'ax'", "did you mean 'a_x'?")),
        ("sign = -1", "sign = -2", ("channels.a_x.sign: -2", "1 or -1")),
        ('source = "Decel"\n', "source = 5\n", ("channels.a_x.source: 5", "the name of a column")),
        ('"Decel"', '"true_ax"', ("truth",)),
        ('"kPa"', '"kPo"', ("channels.p_mc.unit", "'kPo'", "did you mean 'kPa'")),
        ("scale = 2.0", "scale = 0", ("channels.p_mc.scale: 0 would make every value 0",)),
        ("schema = 1", "schema = 1\nignore = 3", ("ignore", "a list of names")),
        ("schema = 1", "schema = 1\ntext.separator = 'x'", ("text.separator: 'x'", "';'")),
        ("schema = 1", "schema = 1\ntext.decimal = ';'", ("text.decimal: ';'", "one of '.', ','")),
        ("schema = 1", "schema = 1\ntext.encoding = 'latin-77'", ("latin-77",)),
    ],
)
def test_slips_are_named(tmp_path, old, new, words):
    message = refused(write_map(tmp_path, MAP.replace(old, new, 1)))
    assert [word for word in words if word not in message] == []


def test_dbc_files_are_relative_to_the_map(tmp_path):
    text = "schema = 1\ndbc = {}\n"
    one = read_channel_map(write_map(tmp_path, text.format('"a.dbc"')))
    assert (one.databases.files, one.channels) == ((DatabaseFile(tmp_path / "a.dbc"),), {})
    two = read_channel_map(write_map(tmp_path, text.format('["a.dbc", "/x/b.dbc"]')))
    assert two.databases.files == (DatabaseFile(tmp_path / "a.dbc"), DatabaseFile(Path("/x/b.dbc")))
    assert read_channel_map(write_map(tmp_path, MAP)).databases.files == ()


@pytest.mark.parametrize(
    "dbc",
    [
        "5",
        '{1 = {bus = "Motor"}}',
        '{1 = {file = "a", bus = ""}}',
        '""',
        '["a.dbc", 5]',
        "{can0 = 5}",
        "{}",
        "{'' = 'a.dbc'}",
    ],
)
def test_dbc_that_is_no_path(tmp_path, dbc):
    assert "expected the path of a DBC file" in refused(
        write_map(tmp_path, f"schema = 1\ndbc = {dbc}\n")
    )


def test_a_dbc_for_each_bus(tmp_path):
    text = 'schema = 1\n[dbc]\n1 = "a.dbc"\ncan0 = ["b.kcd", "/x/c.arxml"]\n'
    found = read_channel_map(write_map(tmp_path, text))
    assert found.databases.files == ()
    assert found.databases.buses == (
        ("1", (DatabaseFile(tmp_path / "a.dbc"),)),
        ("can0", (DatabaseFile(tmp_path / "b.kcd"), DatabaseFile(Path("/x/c.arxml")))),
    )
    assert found.databases.all == (*found.databases.buses[0][1], *found.databases.buses[1][1])


ONE_BUS = '{file = "car.kcd", bus = "Motor"}'


@pytest.mark.parametrize(
    ("written", "bus"),
    [
        (ONE_BUS, ""),
        (f"[{ONE_BUS}]", ""),
        (f"{{1 = {ONE_BUS}}}", "1"),
        (f"{{1 = [{ONE_BUS}]}}", "1"),
    ],
)
def test_one_bus_of_a_file(tmp_path, written, bus):
    found = read_channel_map(write_map(tmp_path, f"schema = 1\ndbc = {written}\n"))
    file = DatabaseFile(tmp_path / "car.kcd", "Motor")
    assert (found.databases.files, found.databases.buses) == (
        ((), (("1", (file,)),)) if bus else ((file,), ())
    )


@pytest.mark.parametrize(
    ("written", "sources"), [('"any"', ()), ("[0x0B]", (11,)), ("[0, 253]", (0, 253))]
)
def test_j1939_source_addresses(tmp_path, written, sources):
    text = f'schema = 1\ndbc = "a.dbc"\nj1939 = {written}\n'
    assert read_channel_map(write_map(tmp_path, text)).databases.sources == sources
    assert read_channel_map(write_map(tmp_path, MAP)).databases.sources is None


@pytest.mark.parametrize("written", ['"all"', "11", "[]", "[254]", "[-1]", '["11"]', "[true]"])
def test_what_is_no_source_address(tmp_path, written):
    text = f'schema = 1\ndbc = "a.dbc"\nj1939 = {written}\n'
    assert "j1939: " in refused(write_map(tmp_path, text))


def test_a_source_may_be_named_by_its_whole_header_cell(tmp_path, log_file):
    log_file.write_text(log_file.read_text().replace("Zeit [ms]", "Zeit(ms)"))
    log = read_log(log_file, write_map(tmp_path, MAP.replace('"Zeit"', '"Zeit(ms)"')))
    assert log.time[1] == pytest.approx(0.005)


def test_the_log_says_what_was_taken_from_what(tmp_path, log_file):
    log = read_log(log_file, write_map(tmp_path, MAP))
    origins = {o.channel: o for o in log.origins}
    p = origins["p_mc"]
    assert (p.source, p.unit) == ("Brake pressure", "kPa")
    assert (p.factor, p.offset) == (pytest.approx(2000), pytest.approx(-10e3))
    assert origins["a_x"].factor == pytest.approx(-9.80665)


def test_a_map_tells_how_the_text_is_written(tmp_path):
    path = tmp_path / "run.csv"
    rows = [";".join([str(i + 1), *["1,234"] * 6]) for i in range(60)]
    names = (
        "time [s];p_mc [bar];a_x [g];omega_fl [rpm];omega_fr [rpm];omega_rl [rpm];omega_rr [rpm]"
    )
    path.write_text("\n".join([names, *rows, ""]))
    with pytest.raises(LogError, match="decimal mark is ambiguous"):
        read_log(path)
    log = read_log(path, write_map(tmp_path, "schema = 1\n[text]\ndecimal = ','\n"))
    assert log["p_mc"][0] == pytest.approx(1.234e5)
