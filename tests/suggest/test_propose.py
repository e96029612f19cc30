"""A known run under foreign names is found again; nothing is invented; doubts are told."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calib.base.errors import InputError
from calib.logs.channel_map import ChannelMap, DatabaseFile, Databases
from calib.logs.channel_map_file import read_channel_map
from calib.logs.read import open_log, read_log
from calib.logs.source import Column, ColumnSource
from calib.suggest.propose import Suggestion, suggest, to_toml
from tests.support.made_runs import made_run, stop

SAMPLES = Path(__file__).parents[2] / "sample_logs"
WHEELS = ("fl", "fr", "rl", "rr")
RUN = made_run(stop(), rate=100.0)
N = RUN.time.size
RNG = np.random.default_rng(3)


def foreign(run=RUN):
    """The run as another logger has it: by (name, unit) the written values."""
    return {
        ("Zeit", "ms"): 1e3 * run.time,
        ("Yaw rate", "deg/s"): RNG.normal(size=run.time.size),
        ("Engine speed", "rpm"): 900 + RNG.normal(size=run.time.size),
        ("Lateral acceleration", "g"): RNG.normal(size=run.time.size) / 9,
        ("Longitudinal deceleration", "g"): -run["a_x"] / 9.80665,
        ("Bremsdruck HZ", "MPa"): run["p_mc"] / 1e6,
        ("Tyre pressure", "bar"): np.full(run.time.size, 2.4),
        **{
            (f"nRad_{name}", "U/min"): run[f"omega_{w}"] * 30 / np.pi
            for w, name in zip(WHEELS, ("VL", "VR", "HL", "HR"), strict=True)
        },
        ("Fahrzeuggeschwindigkeit", "km/h"): 3.6 * run["v"],
        ("Driver", None): np.full(run.time.size, 7.0),
    }


def source_of(columns):
    values = list(columns.values())
    names = tuple(Column(name, unit) for name, unit in columns)
    return ColumnSource(names, lambda indices: [values[i] for i in indices])


def suggestion(columns, **told):
    return suggest(source_of(columns), "run.csv", **told)


def found(columns, **told):
    return {p.channel: p for p in suggestion(columns, **told).proposals}


def without(columns, *names):
    return {key: x for key, x in columns.items() if key[0] not in names}


def test_a_foreign_log_is_found_out():
    result = suggestion(foreign())
    by_name = {p.channel: p.mapping.source for p in result.proposals}
    assert by_name == {
        "time": "Zeit",
        "p_mc": "Bremsdruck HZ",
        "a_x": "Longitudinal deceleration",
        "omega_fl": "nRad_VL",
        "omega_fr": "nRad_VR",
        "omega_rl": "nRad_HL",
        "omega_rr": "nRad_HR",
        "v": "Fahrzeuggeschwindigkeit",
    }
    assert {p.sure for p in result.proposals} == {"sure"}
    assert not result.doubts
    assert not result.missing
    assert set(result.left) == {
        *("Yaw rate", "Engine speed", "Lateral acceleration", "Tyre pressure", "Driver")
    }


def test_the_map_reads_the_run_back(tmp_path):
    columns = foreign()
    path, channel_map = tmp_path / "run.csv", tmp_path / "map.toml"
    rows = np.column_stack(list(columns.values()))
    head = ";".join(f"{name} [{unit or ''}]" for name, unit in columns)
    np.savetxt(path, rows, delimiter=";", header=head, comments="", fmt="%.9f")
    channel_map.write_text(to_toml(suggest(open_log(path).source, str(path))))
    log = read_log(path, channel_map)
    for name in ("time", "a_x", "p_mc", "v", *(f"omega_{w}" for w in WHEELS)):
        np.testing.assert_allclose(log[name], RUN[name], rtol=1e-6, atol=2e-3)
    assert read_channel_map(channel_map).channels["a_x"].sign == -1


@pytest.mark.parametrize("lost", ["Bremsdruck HZ", "Longitudinal deceleration", "nRad_VL"])
def test_what_is_not_there_is_not_invented(lost):
    result = suggestion(without(foreign(), lost))
    channel = {"Bremsdruck HZ": "p_mc", "nRad_VL": "omega_fl"}.get(lost, "a_x")
    assert channel in result.missing
    assert channel not in {p.channel for p in result.proposals}
    assert not result.doubts


RIGHT = {p.channel: p.mapping for p in suggestion(foreign()).proposals}


@settings(max_examples=25)
@given(
    kept=st.sets(st.sampled_from([name for name, _ in foreign()]), min_size=1),
    order=st.randoms(use_true_random=False),
)
def test_whatever_is_kept_nothing_wrong_is_proposed(kept, order):
    """Any selection of columns, in any order: each proposal is the right one or there is none."""
    columns = [(key, x) for key, x in foreign().items() if key[0] in kept]
    order.shuffle(columns)
    for channel, proposal in found(dict(columns)).items():
        assert proposal.mapping == RIGHT[channel]


def test_a_torque_is_no_pressure():
    columns = without(foreign(), "Bremsdruck HZ")
    columns[("Brake torque", "Nm")] = RUN["p_mc"] / 1e3
    result = suggestion(columns)
    assert "Brake torque" in result.left
    assert "p_mc" in result.missing


@pytest.mark.parametrize(
    ("name", "channel"),
    [
        ("Mot_Trq_Front", "T_drive_f"),
        ("Antriebsmoment HA", "T_drive_r"),
        ("T_drive_r", "T_drive_r"),
        ("Motor torque", None),  # of which axle?
        ("Drive torque request front", None),
        ("Front brake torque", None),
    ],
)
def test_a_torque_of_the_drive_is_found_by_its_name(name, channel):
    columns = {**foreign(), (name, "Nm"): -80.0 + RNG.normal(size=N)}
    result = suggestion(columns)
    proposed = {p.channel: p.mapping.source for p in result.proposals if "drive" in p.channel}
    assert proposed == ({channel: name} if channel else {})
    assert (name in result.left) is (channel is None)


def test_a_pressure_that_was_computed_from_a_torque_is_none():
    columns = without(foreign(), "Bremsdruck HZ")
    columns[("p_mc", "bar")] = np.round(RUN["p_mc"] / 1e5, 4)
    columns[("Brake torque", "Nm")] = np.round(RUN["p_mc"] / 1e3, 2)
    result = suggestion(columns)
    assert "p_mc" in result.missing
    assert result.ignore == ("p_mc",)


def test_a_pressure_behind_the_deceleration_is_none():
    columns = foreign()
    shift = 20
    pressure = columns[("Bremsdruck HZ", "MPa")]
    columns[("Bremsdruck HZ", "MPa")] = np.concatenate([pressure[:shift], pressure[:-shift]])
    result = suggestion(columns)
    assert "Bremsdruck HZ" in result.left
    assert "p_mc" in result.missing


def test_a_wrong_unit_of_acceleration_is_asked():
    columns = without(foreign(), "Longitudinal deceleration")
    columns[("Longitudinal deceleration", "m/s^2")] = -RUN["a_x"] / 9.80665
    (doubt,) = suggestion(columns).doubts
    assert doubt.channel == "a_x"


def test_two_pressures_are_asked_and_told():
    columns = foreign()
    columns[("Bremsdruck HZ 2", "bar")] = RUN["p_mc"] / 1e5
    (doubt,) = suggestion(columns).doubts
    assert doubt.channel == "p_mc"
    assert set(doubt.candidates) == {"Bremsdruck HZ", "Bremsdruck HZ 2"}
    result = suggestion(columns, told={"p_mc": "Bremsdruck HZ 2"})
    assert not result.doubts
    assert {p.channel: p.mapping.source for p in result.proposals}["p_mc"] == "Bremsdruck HZ 2"


def test_a_pressure_without_a_unit_is_asked_and_told():
    columns = without(foreign(), "Bremsdruck HZ")
    columns[("Brake pressure", None)] = RUN["p_mc"] / 1e5
    (doubt,) = suggestion(columns).doubts
    assert doubt.channel == "p_mc"
    told = found(columns, told={"p_mc": "Brake pressure [bar]"})["p_mc"]
    assert (told.mapping.source, told.mapping.unit) == ("Brake pressure", "bar")


@pytest.mark.parametrize(
    "told",
    [{"p_cm": "Zeit"}, {"p_mc": "Druck"}, {"p_mc": "nRad_VL"}, {"p_mc": "Driver [rpm]"}],
)
def test_telling_what_cannot_be(told):
    with pytest.raises(InputError):
        suggestion(foreign(), told=told)


def test_speeds_at_the_rim_need_a_radius():
    columns = {k: x for k, x in foreign().items() if not k[0].startswith("nRad")}
    for wheel in WHEELS:
        columns[(f"WheelSpeed_{wheel.upper()}", "km/h")] = RUN[f"omega_{wheel}"] * 0.3 * 3.6
    (doubt,) = suggestion(columns).doubts
    assert doubt.channel.startswith("omega_fl")
    mapping = found(columns, radius=0.3)["omega_fl"].mapping
    assert (mapping.unit, mapping.scale) == ("rad/s", pytest.approx(1 / 3.6 / 0.3))


def test_wheels_without_a_unit_are_asked():
    """17 could be rad/s or km/h: a radius of 0.278 m makes both alike."""
    columns = {(n, None if n.startswith("nRad") else u): x for (n, u), x in foreign().items()}
    (doubt,) = suggestion(columns).doubts
    assert doubt.channel == "omega_fl ... omega_rr"


def test_a_wheel_that_does_not_go_with_the_others_is_none():
    columns = foreign()
    columns[("nRad_HL", "U/min")] = RNG.normal(size=N) + 300
    result = suggestion(columns)
    assert "omega_rl" in result.missing
    assert "nRad_HL" in result.left


@pytest.mark.parametrize(("scale", "unit"), [(1.0, "s"), (1e3, "ms"), (1e6, "us")])
def test_a_clock_without_a_unit_is_told_by_its_rate(scale, unit):
    columns = {("timestamp", None): scale * RUN.time, **without(foreign(), "Zeit")}
    clock = found(columns)["time"]
    assert (clock.mapping.unit, clock.sure) == (unit, "likely")


def test_a_coast_is_only_likely():
    coast = made_run(lambda t: 0.0 * t, rate=100.0)
    proposals = found(foreign(coast))
    assert proposals["p_mc"].sure == proposals["a_x"].sure == "likely"


@pytest.mark.parametrize(
    "path", sorted(p for p in SAMPLES.glob("*/*") if p.suffix in (".csv", ".parquet")), ids=str
)
def test_our_own_logs_are_taken_as_they_are(path):
    result = suggest(open_log(path).source, str(path))
    assert not result.doubts
    assert all(p.mapping.source == p.channel and p.mapping.sign == 1 for p in result.proposals)
    assert list(result.missing) == (["p_mc"] if path.parent.name == "real" else [])


def test_names_with_quotes_and_backslashes_stay_whole(tmp_path):
    columns = without(foreign(), "Zeit")
    columns[('t "\\\\x" #1\x7f', "s")] = RUN.time
    path = tmp_path / "map.toml"
    path.write_text(to_toml(suggestion(columns)))
    assert read_channel_map(path).channels["time"].source == 't "\\\\x" #1\x7f'


def test_an_unnamed_acceleration_needs_physics():
    columns = without(foreign(), "Longitudinal deceleration")
    columns[("acc 1", "g")] = -RUN["a_x"] / 9.80665
    assert found(columns)["a_x"].sure == "likely"
    still = made_run(lambda t: 0.0 * t, rate=100.0)
    columns = without(foreign(still), "Longitudinal deceleration")
    columns[("acc 1", "g")] = -still["a_x"] / 9.80665
    assert "a_x" in suggestion(columns).missing


def with_lost(name, start, end):
    """The foreign log in which one column has no value in these rows."""
    columns = foreign()
    key = next(key for key in columns if key[0] == name)
    columns[key] = columns[key].copy()
    columns[key][start:end] = np.nan
    return columns


def test_a_lost_message_does_not_cost_the_channel():
    columns = with_lost("Fahrzeuggeschwindigkeit", 300, 310)
    assert found(columns)["v"].mapping.source == "Fahrzeuggeschwindigkeit"


def test_a_long_gap_is_told_with_its_place():
    result = suggestion(with_lost("Fahrzeuggeschwindigkeit", 300, 360))
    assert "v" not in {p.channel for p in result.proposals}
    assert "Fahrzeuggeschwindigkeit" in result.left


def test_of_two_speeds_the_finer_one_is_taken():
    """Also where it lost a message, and the coarse one is named as well or better."""
    columns = with_lost("Fahrzeuggeschwindigkeit", 300, 310)
    coarse = np.full(N, np.nan)
    coarse[::11] = 3.6 * RUN["v"][::11]
    coarse[-1] = 3.6 * RUN["v"][-1]
    columns[("GPS vehicle speed", "km/h")] = coarse
    result = suggestion(columns)
    assert {p.channel: p.mapping.source for p in result.proposals}["v"] == "Fahrzeuggeschwindigkeit"
    assert "GPS vehicle speed" in result.left
    assert not result.doubts


@pytest.mark.parametrize("unit", ["ms", None])
def test_a_repeated_time_stamp_is_told_as_what_it_is(unit):
    """The column is the time; the rows that repeat one are named."""
    time = 1e3 * RUN.time
    time[400] = time[399]
    columns = {("Zeit", unit): time, **without(foreign(), "Zeit")}
    result = suggestion(columns)
    assert {p.channel for p in result.proposals} == {
        *("time", "p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr", "v")
    }
    assert not result.doubts


@pytest.mark.parametrize(("row", "value"), [(400, 0.0), (400, np.nan), (slice(400, 500), 1.0)])
def test_a_time_that_does_not_run_is_told_as_what_it_is(row, value):
    time = 1e3 * RUN.time
    time[row] = value
    columns = {("Zeit", "ms"): time, **without(foreign(), "Zeit")}
    (doubt,) = suggestion(columns).doubts
    assert (doubt.channel, doubt.candidates) == ("time", ("Zeit",))


def test_wheels_that_are_told_respect_the_radius():
    columns = {k: x for k, x in foreign().items() if not k[0].startswith("nRad")}
    for wheel in WHEELS:
        columns[(f"Rim {wheel.upper()}", "km/h")] = RUN[f"omega_{wheel}"] * 0.3 * 3.6
    told = {f"omega_{wheel}": f"Rim {wheel.upper()}" for wheel in WHEELS}
    result = suggestion(columns, told=told, radius=0.3)
    mapping = {p.channel: p.mapping for p in result.proposals}["omega_fl"]
    assert (mapping.unit, mapping.scale) == ("rad/s", pytest.approx(1 / 3.6 / 0.3))
    assert {p.channel for p in result.proposals} >= {"p_mc", "a_x", "v"}
    with pytest.raises(InputError):
        suggestion(columns, told=told)


@pytest.mark.parametrize(("unit", "taken"), [("1", True), ("-", True), ("Nm", False), ("%", False)])
def test_a_count_beside_its_pressure_is_no_source_of_it(unit, taken):
    """An analogue input and what it was scaled to; a torque or a demand is another matter."""
    columns = {**foreign(), ("Raw", unit): RUN["p_mc"] / 1e3}
    result = suggestion(columns)
    assert ("p_mc" in {p.channel for p in result.proposals}) is taken
    assert ("Bremsdruck HZ" in result.left) is not taken


def test_a_run_of_carsim():
    places = dict(zip(WHEELS, ("L1", "R1", "L2", "R2"), strict=True))
    columns = {
        ("Time", "s"): RUN.time,
        ("Vx", "km/h"): 3.6 * RUN["v"],
        ("Ax", "g's"): RUN["a_x"] / 9.80665,
        ("Pbk_Con", "MPa"): RUN["p_mc"] / 1e6,
        **{(f"AVy_{p}", "rpm"): RUN[f"omega_{w}"] * 30 / np.pi for w, p in places.items()},
        **{(f"Pbk_{p}", "MPa"): 0.9 * RUN["p_mc"] / 1e6 for p in places.values()},
    }
    result = suggestion(columns)
    by_name = {p.channel: p.mapping.source for p in result.proposals}
    assert by_name == {
        "time": "Time",
        "v": "Vx",
        "a_x": "Ax",
        "p_mc": "Pbk_Con",
        **{f"omega_{w}": f"AVy_{p}" for w, p in places.items()},
        **{f"p_{w}": f"Pbk_{p}" for w, p in places.items()},
    }
    assert not result.doubts


@pytest.mark.parametrize("sources", [None, (), (0x0B, 0x21)])
@pytest.mark.parametrize("by_bus", [False, True])
def test_databases_and_source_addresses_are_kept(tmp_path, sources, by_bus):
    files = (DatabaseFile(tmp_path / "a.dbc"), DatabaseFile(tmp_path / "b.kcd", "Motor"))
    for file in files:
        file.path.write_text("")
    buses = (("1", files[:1]), ("can0", files[1:])) if by_bus else ()
    known = Databases(() if by_bus else files, buses, sources)
    used = ChannelMap("old.toml", {}, databases=known)
    found = Suggestion("x.blf", (), (), {}, {}, ())
    written = tmp_path / "map.toml"
    written.write_text(to_toml(found, used, tmp_path) + '[channels.v]\nsource = "speed"\n')
    assert read_channel_map(written).databases == known
