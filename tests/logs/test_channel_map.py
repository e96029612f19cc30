"""Channel maps: foreign names, units and signs."""

import pytest

from calib.base.errors import ChannelMapError, LogError
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
for wheel in ("fl", "fr", "rl", "rr"):
    MAP += f'[channels.omega_{wheel}]\nsource = "{wheel.upper()}"\n'


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


def read_map(tmp_path, text):
    return read_channel_map(write_map(tmp_path, text))


def test_names_units_signs_scale_and_offset(tmp_path, log_file):
    """A source is a name, or its whole cell; the log says what was taken from what."""
    log_file.write_text(log_file.read_text().replace("Zeit [ms]", "Zeit(ms)"))
    log = read_log(log_file, write_map(tmp_path, MAP.replace('"Zeit"', '"Zeit(ms)"')))
    assert log.time[1] == pytest.approx(0.005)
    assert log["p_mc"][:2] == pytest.approx([(2 * 10 - 10) * 1e3, (2 * 11 - 10) * 1e3])
    assert log["a_x"][0] == pytest.approx(-0.5 * 9.80665)
    assert log["omega_fl"][0] == pytest.approx(2 * 3.141592653589793)
    assert log.ignored == ("p_mc",)  # hidden by the map
    origins = {origin.channel: origin for origin in log.origins}
    p = origins["p_mc"]
    assert (p.source, p.unit) == ("Brake pressure", "kPa")
    assert (p.factor, p.offset) == (pytest.approx(2000), pytest.approx(-10e3))
    assert origins["a_x"].factor == pytest.approx(-9.80665)


def test_a_source_that_is_not_there_or_twice(tmp_path, log_file):
    with pytest.raises(ChannelMapError, match="'Decel'"):
        read_log(log_file, write_map(tmp_path, MAP.replace('"Decel"', '"Deccel"')))
    log_file.write_text(log_file.read_text().replace("p_mc [bar]", "Decel [g]"))
    with pytest.raises(LogError, match="'Decel'"):
        read_log(log_file, write_map(tmp_path, MAP))


def in_map(*lines):
    return "\n".join(["schema = 1", *lines, ""])


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (MAP.replace("[channels.a_x]", "[channels.ax]"), "'a_x'"),
        (MAP.replace("sign = -1", "sign = -2"), "channels.a_x.sign: -2"),
        (MAP.replace("sign = -1", "sign = true"), "channels.a_x.sign: True"),
        (MAP.replace('source = "Decel"\n', "source = 5\n"), "channels.a_x.source: 5"),
        (MAP.replace('"Decel"', '"true_ax"'), "truth"),
        (MAP.replace('"kPa"', '"kPo"'), "channels.p_mc.unit: unknown unit 'kPo'"),
        (MAP.replace("scale = 2.0", "scale = 0"), "channels.p_mc.scale: 0"),
        (in_map("ignore = 3"), "ignore"),
        (in_map("text.separator = 'x'"), "text.separator: 'x'"),
        (in_map("text.decimal = ';'"), "text.decimal: ';'"),
        (in_map("text.encoding = 'latin-77'"), "latin-77"),
        *((in_map(f"dbc = {dbc}"), "dbc")
          for dbc in ("5", '""', '["a.dbc", 5]', "{}", "{can0 = 5}", "{'' = 'a.dbc'}")),
    ],
)  # fmt: skip
def test_mistakes_are_named(tmp_path, text, key):
    path = write_map(tmp_path, text)
    assert key in refusal(read_channel_map, path, kind=ChannelMapError, names=path)


@pytest.mark.parametrize(
    ("written", "databases"),
    [
        ('"a.dbc"', {"": ["a.dbc"]}),
        ('["a.dbc", "/x/b.dbc"]', {"": ["a.dbc", "/x/b.dbc"]}),
        ('{1 = "a.dbc", can0 = ["b.kcd", "/x/c.arxml"]}',
         {"1": ["a.dbc"], "can0": ["b.kcd", "/x/c.arxml"]}),
    ],
)  # fmt: skip
def test_databases_are_relative_to_the_map(tmp_path, written, databases):
    expected = {bus: tuple(tmp_path / name for name in names) for bus, names in databases.items()}
    assert read_map(tmp_path, in_map(f"dbc = {written}")).databases == expected
