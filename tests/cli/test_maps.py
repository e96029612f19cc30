"""`brake-cal map` as the shell runs it, and what `check --map` says of it."""

import tomllib
from pathlib import Path

import pytest

from tests.cli.conftest import parsed
from tests.support.recordings import write_bus, write_dbc

REAL = Path(__file__).parents[2] / "sample_logs/real"
TAKE = ("--take", "p_mc=Brake pressure [bar]")


@pytest.fixture
def foreign(tmp_path):
    """The Mustang's braking with foreign names, and a pressure without a unit."""
    lines = (REAL / "mustang_brake.csv").read_text().splitlines()
    head = lines[0].replace("p_mc [bar]", "Brake pressure").replace("T_b_req_oem [N*m]", "x [V]")
    head = head.replace("a_x [", "LongAcc [").replace("omega_", "WS_")
    path = tmp_path / "run.csv"
    path.write_text("\n".join([head, *lines[1:], ""]))
    return path


def test_the_maps_beside_the_logs_are_what_is_suggested(brake_cal, monkeypatch):
    monkeypatch.chdir(REAL)
    for car in ("mustang", "toyota"):
        ran = brake_cal("map", f"{car}_brake.csv")
        assert ran.out == Path(f"{car}.toml").read_text()


def test_doubts_end_with_3_and_no_map(brake_cal, foreign, tmp_path):
    out = tmp_path / "map.toml"
    ran = brake_cal("map", foreign, "--out", out)
    assert (ran.code, ran.result) == (3, "")
    assert "p_mc: named a brake pressure" in ran.err
    assert "--take 'p_mc=NAME [bar]'" in ran.err
    assert not out.exists()


def test_a_named_channel_is_written_and_read(brake_cal, foreign, tmp_path):
    out = tmp_path / "map.toml"
    assert brake_cal("map", foreign, *TAKE, "--out", out).code == 0
    ran = brake_cal("check", foreign, "--map", out, "-v")
    assert "from 'LongAcc' [m/s^2] x 1\n" in ran.out
    assert "from 'Brake pressure' [bar] x 100000\n" in ran.out
    channels = parsed(brake_cal("check", foreign, "--map", out, "--json"))["logs"][0]["taken"]
    pressure = next(item for item in channels if item["channel"] == "p_mc")
    assert pressure["source"] == "Brake pressure"
    assert pressure["factor"] == pytest.approx(1e5)


def test_a_map_is_replaced_until_somebody_edits_it(brake_cal, foreign, tmp_path):
    out = tmp_path / "map.toml"
    assert brake_cal("map", foreign, *TAKE, "--out", out).code == 0
    first = out.read_text()
    assert brake_cal("map", foreign, *TAKE, "--take", "v=", "--out", out).code == 0
    assert out.read_text() != first
    out.write_text(first + "# mine\n")
    assert brake_cal("map", foreign, *TAKE, "--out", out).code == 2
    assert out.read_text() == first + "# mine\n"
    assert brake_cal("map", foreign, *TAKE, "--out", out, "--force").code == 0
    assert out.read_text() == first


def test_the_map_of_a_bus_log_is_usable_at_once(brake_cal, tmp_path):
    """With the DBC of the map that it was opened with, from another folder, too."""
    (tmp_path / "bus").mkdir()
    bus_map = write_dbc(tmp_path / "bus")
    log = write_bus(tmp_path / "run.asc")
    bus_map.write_text('schema = 1\ndbc = "chassis.dbc"\n')
    out = tmp_path / "maps" / "new.toml"
    out.parent.mkdir()
    ran = brake_cal("map", log, "--map", bus_map, "--out", out)
    assert ran.code == 0, ran.err
    assert 'dbc = ["../bus/chassis.dbc"]' in out.read_text()
    assert brake_cal("check", log, "--map", out).code == 0
    printed = tmp_path / "printed.toml"
    printed.write_text(brake_cal("map", log, "--map", bus_map).out)
    assert brake_cal("check", log, "--map", printed).code == 0


def with_time(tmp_path, heads, cells):
    """The Toyota's braking, its time under ``heads``, in the cells that ``cells`` makes of it."""
    rows = [line.split(",") for line in (REAL / "toyota_brake.csv").read_text().splitlines()]
    column = rows[0].index("time [s]")
    rows[0][column] = heads
    for row in rows[1:]:
        row[column] = cells(float(row[column]))
    path = tmp_path / "run.csv"
    path.write_text("\n".join([*(",".join(row) for row in rows), ""]))
    return path


def test_of_two_columns_of_one_name_the_unit_chooses(brake_cal, tmp_path):
    log = with_time(tmp_path, "Time [s],Time [min]", lambda t: f"{t!r},{t / 60!r}")
    out = tmp_path / "map.toml"
    ran = brake_cal("map", log, "--out", out)
    assert (ran.code, out.exists()) == (3, False)
    assert "Time [s], Time [min]" in ran.err
    assert brake_cal("map", log, "--take", "time=Time", "--out", out).code == 3
    brake_cal("map", log, "--take", "time=Time [s]", "--out", out)
    assert tomllib.loads(out.read_text())["channels"]["time"]["source"] == "Time [s]"
    assert brake_cal("log", log, "--map", out).code == 0


def test_a_clock_time_is_the_time(brake_cal, tmp_path):
    log = with_time(tmp_path, "Uhrzeit", lambda t: f"10:{int(t) // 60:02d}:{t % 60:06.3f}")
    out = tmp_path / "map.toml"
    assert brake_cal("map", log, "--out", out).code == 1  # it has no pressure
    assert tomllib.loads(out.read_text())["channels"]["time"]["source"] == "Uhrzeit"
    assert brake_cal("log", log, "--map", out).code == 0
