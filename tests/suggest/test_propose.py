"""A known run under foreign names is found again; nothing is invented; doubts are asked."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calib.base.errors import InputError
from calib.logs.channel_map import ChannelMap
from calib.logs.channel_map_file import read_channel_map
from calib.logs.formats import as_table
from calib.logs.read import open_log, read_log
from calib.logs.source import Column, ColumnSource
from calib.suggest.propose import Suggestion, suggest, to_toml
from calib.suggest.words import score, split_wheel, wheel_of
from tests.support.made_runs import made_run, stop

SAMPLES = Path(__file__).parents[2] / "sample_logs"
WHEELS = ("fl", "fr", "rl", "rr")
RUN = made_run(stop(), rate=100.0)
N = RUN.time.size
ROWS = np.arange(N)
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


def suggested(path):
    with open_log(path) as opened:
        return suggest(as_table(opened.source, str(path)), str(path))


def suggestion(columns, **options):
    return suggest(source_of(columns), "run.csv", **options)


def proposals_of(columns, **options):
    return {p.channel: p for p in suggestion(columns, **options).proposals}


def without(columns, *names):
    return {key: x for key, x in columns.items() if key[0] not in names}


def test_a_foreign_log_is_found_out():
    result = suggestion(foreign())
    assert {p.sure for p in result.proposals} == {"sure"}
    assert not result.doubts
    assert not result.missing
    others = {"Yaw rate", "Engine speed", "Lateral acceleration", "Tyre pressure", "Driver"}
    assert set(result.unused) == others


def test_the_map_reads_the_run_back(tmp_path):
    columns = foreign()
    path, channel_map = tmp_path / "run.csv", tmp_path / "map.toml"
    rows = np.column_stack(list(columns.values()))
    head = ";".join(f"{name} [{unit or ''}]" for name, unit in columns)
    np.savetxt(path, rows, delimiter=";", header=head, comments="", fmt="%.9f")
    channel_map.write_text(to_toml(suggested(path)))
    log = read_log(path, channel_map)
    for name in ("time", "a_x", "p_mc", "v", *(f"omega_{w}" for w in WHEELS)):
        np.testing.assert_allclose(log[name], RUN[name], rtol=1e-6, atol=2e-3)
    assert read_channel_map(channel_map).channels["a_x"].sign == -1


RIGHT = {p.channel: p.mapping for p in suggestion(foreign()).proposals}


@settings(max_examples=25)
@given(
    names=st.sets(st.sampled_from([name for name, _ in foreign()]), min_size=1),
    order=st.randoms(use_true_random=False),
)
def test_nothing_wrong_is_proposed_for_any_columns(names, order):
    """Any selection of columns, in any order: each proposal is the right one or there is none."""
    columns = [(key, x) for key, x in foreign().items() if key[0] in names]
    order.shuffle(columns)
    for channel, proposal in proposals_of(dict(columns)).items():
        assert proposal.mapping == RIGHT[channel]


def with_values(name, value, unit=None):
    """The foreign log in which one column has other values, and perhaps another unit."""
    key = next(key for key in foreign() if key[0] == name)
    return {**without(foreign(), name), (name, unit or key[1]): value}


def with_gap(name, rows):
    """The foreign log in which one column has no value in these rows."""
    columns = foreign()
    (key,) = (key for key in columns if key[0] == name)
    columns[key] = columns[key].copy()
    columns[key][rows] = np.nan
    return columns


P, A, V = "Bremsdruck HZ", "Longitudinal deceleration", "Fahrzeuggeschwindigkeit"
TORQUE = {("Brake torque", "Nm"): np.round(RUN["p_mc"] / 1e3, 2)}
PRESSURE = RUN["p_mc"] / 1e6
COAST = made_run(lambda t: 0.0 * t, rate=100.0)
TIME = 1e3 * RUN.time


@pytest.mark.parametrize(
    ("columns", "channel", "unused"),
    [
        (without(foreign(), P), "p_mc", "Tyre pressure"),
        (without(foreign(), A), "a_x", "Lateral acceleration"),
        (without(foreign(), "nRad_VL"), "omega_fl", "Engine speed"),
        (without(foreign(), P) | TORQUE, "p_mc", "Brake torque"),
        (with_values(P, np.concatenate([PRESSURE[:60], PRESSURE[:-60]])), "p_mc", P),
        (with_values("nRad_HL", RNG.normal(size=N) + 300), "omega_rl", "nRad_HL"),
        (with_gap(V, slice(300, 360)), "v", V),
        (foreign() | {("Raw", "Nm"): PRESSURE}, "p_mc", P),
        *((foreign() | {(name, "Nm"): RNG.normal(size=N) - 80.0}, "T_drive_f", name)
          for name in ("Motor torque", "Drive torque request front")),
        (foreign() | {("Raw", "%"): PRESSURE}, "p_mc", P),
        (without(foreign(COAST), A) | {("acc 1", "g"): -COAST["a_x"] / 9.8}, "a_x", "acc 1"),
    ],
    ids=["no pressure", "no deceleration", "no wheel", "torque", "late pressure", "another wheel",
         "long gap", "of a torque", "of no axle", "asked for", "of a demand", "unnamed at a coast"],
)  # fmt: skip
def test_no_channel_is_invented(columns, channel, unused):
    result = suggestion(columns)
    assert channel not in {p.channel for p in result.proposals}
    assert channel in ("v", "T_drive_f") or channel in result.missing
    assert unused in result.unused


def test_a_pressure_that_was_computed_from_a_torque_is_none():
    columns = without(foreign(), P) | {("p_mc", "bar"): np.round(RUN["p_mc"] / 1e5, 4)} | TORQUE
    result = suggestion(columns)
    assert "p_mc" in result.missing
    assert result.ignore == ("p_mc",)


RIM = without(foreign(), *(f"nRad_{w}" for w in ("VL", "VR", "HL", "HR"))) | {
    (f"WheelSpeed_{w.upper()}", "km/h"): RUN[f"omega_{w}"] * 0.3 * 3.6 for w in WHEELS
}


@pytest.mark.parametrize(
    ("columns", "doubtful", "options", "expected"),
    [
        (with_values(A, -RUN["a_x"] / 9.80665, "m/s^2"), "a_x", {}, None),
        (
            foreign() | {("Bremsdruck HZ 2", "bar"): RUN["p_mc"] / 1e5},
            "p_mc",
            {"user_specified": {"p_mc": "Bremsdruck HZ 2"}},
            ("Bremsdruck HZ 2", None),
        ),
        (
            without(foreign(), P) | {("Brake pressure", None): RUN["p_mc"] / 1e5},
            "p_mc",
            {"user_specified": {"p_mc": "Brake pressure [bar]"}},
            ("Brake pressure", "bar"),
        ),
        (RIM, "omega_fl", {}, None),
        # 17 could be rad/s or km/h: a radius of 0.278 m makes both alike
        ({(n, None if n[:4] == "nRad" else u): x for (n, u), x in foreign().items()},
         "omega_fl", {}, None),
        *((with_values("Zeit", np.where(np.isin(ROWS, rows), value, TIME)), "time", {}, None)
          for rows, value in ((400, 0.0), (400, np.nan), (range(400, 500), 1.0))),
    ],
    ids=["unit", "two pressures", "no unit", "rim", "wheels without unit",
         "time of zero", "no time", "time that stands"],
)  # fmt: skip
def test_a_doubt_is_asked_and_answered(columns, doubtful, options, expected):
    (doubt,) = suggestion(columns).doubts
    assert doubt.channel.split(" ")[0] == doubtful
    if expected:
        mapping = proposals_of(columns, **options)[doubtful].mapping
        assert (mapping.source, mapping.unit) == expected
        assert mapping.scale == 1.0


def test_wheels_of_the_user_respect_the_radius():
    columns = {(n.replace("WheelSpeed", "Rim"), unit): x for (n, unit), x in RIM.items()}
    of_user = {f"omega_{wheel}": f"Rim_{wheel.upper()}" for wheel in WHEELS}
    for log, user_specified in ((RIM, {}), (columns, of_user)):  # each axle may have a radius
        proposals = proposals_of(log, user_specified=user_specified, radii=(0.3, 0.315))
        mappings = [proposals[f"omega_{wheel}"].mapping for wheel in ("fl", "rr")]
        assert [mapping.unit for mapping in mappings] == ["rad/s", "rad/s"]
        assert [m.scale for m in mappings] == pytest.approx([1 / 3.6 / 0.3, 1 / 3.6 / 0.315])
    with pytest.raises(InputError):
        suggestion(columns, user_specified=of_user)


def test_speeds_at_the_rim_are_no_angular_speeds():
    """Without v their derivative tells g from m/s^2, also if the user wants no wheel speed."""
    assert proposals_of(without(RIM, V), user_specified={"omega_fl": ""})["a_x"].mapping.sign == -1


@pytest.mark.parametrize(
    ("channel", "source"),
    [("p_cm", "Zeit"), ("p_mc", "Druck"), ("p_mc", "nRad_VL"), ("p_mc", "Driver [rpm]")],
)
def test_a_source_that_cannot_be(channel, source):
    with pytest.raises(InputError):
        suggestion(foreign(), user_specified={channel: source})


COARSE = np.where((ROWS % 11 == 0) | (ROWS == N - 1), 3.6 * RUN["v"], np.nan)
REPEATED = np.where(ROWS == 400, TIME[399], TIME)


@pytest.mark.parametrize(
    ("columns", "channel", "source", "sure"),
    [
        (without(foreign(), "Zeit") | {("t", None): RUN.time}, "time", ("t", "s"), "likely"),
        (without(foreign(), "Zeit") | {("t", None): TIME}, "time", ("t", "ms"), "likely"),
        (without(foreign(), "Zeit") | {("t", None): 1e3 * TIME}, "time", ("t", "us"), "likely"),
        (with_values("Zeit", REPEATED), "time", ("Zeit", None), "sure"),
        (foreign(COAST), "p_mc", (P, None), "likely"),
        (foreign(COAST), "a_x", (A, None), "likely"),
        (without(foreign(), A) | {("acc 1", "g"): -RUN["a_x"] / 9.8}, "a_x", ("acc 1", None),
         "likely"),
        (with_gap(V, slice(300, 310)), "v", (V, None), "sure"),
        # the finer one of two, also where it lost a message and the other is named as well
        (with_gap(V, slice(300, 310)) | {("GPS vehicle speed", "km/h"): COARSE}, "v", (V, None),
         "sure"),
        # an analogue input beside what it was scaled to
        (foreign() | {("Raw", "1"): PRESSURE}, "p_mc", (P, None), "sure"),
        (foreign() | {("Raw", "-"): PRESSURE}, "p_mc", (P, None), "sure"),
        *((foreign() | {(name, "Nm"): RNG.normal(size=N) - 80.0}, channel, (name, None), "likely")
          for name, channel in (("Mot_Trq_Front", "T_drive_f"), ("Antriebsmoment HA", "T_drive_r"),
                                ("T_drive_r", "T_drive_r"))),
    ],
)  # fmt: skip
def test_what_is_found(columns, channel, source, sure):
    result = suggestion(columns)
    proposal = {p.channel: p for p in result.proposals}[channel]
    assert (proposal.mapping.source, proposal.mapping.unit) == source
    assert proposal.sure == sure
    assert not result.doubts


@pytest.mark.parametrize(
    "path",
    [SAMPLES / name for name in ("sedan/ramp_wet_asphalt.csv", "sedan/dry_asphalt_stop.csv",
                                 "simulation_study/stop_noisy.parquet",
                                 "third_party/hold2_steps_muf25_mur33.parquet")]
    + sorted(SAMPLES.glob("real/*.csv")), ids=lambda path: path.stem,
)  # fmt: skip
def test_our_own_logs_are_taken_as_they_are(path):
    result = suggested(path)
    assert not result.doubts
    assert all(p.mapping.source == p.channel and p.mapping.sign == 1 for p in result.proposals)
    assert list(result.missing) == (["p_mc"] if path.parent.name == "real" else [])


def test_names_with_quotes_and_backslashes_stay_whole(tmp_path):
    name = 't "\\\\x" #1\x7f'
    path = tmp_path / "map.toml"
    path.write_text(to_toml(suggestion(without(foreign(), "Zeit") | {(name, "s"): RUN.time})))
    assert read_channel_map(path).channels["time"].source == name


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
    assert {p.channel: p.mapping.source for p in result.proposals} == {
        "time": "Time",
        "v": "Vx",
        "a_x": "Ax",
        "p_mc": "Pbk_Con",
        **{f"omega_{w}": f"AVy_{p}" for w, p in places.items()},
        **{f"p_{w}": f"Pbk_{p}" for w, p in places.items()},
    }
    assert not result.doubts


@pytest.mark.parametrize("buses", [("",), ("1", "can0")])
def test_databases_are_kept(tmp_path, buses):
    files = (tmp_path / "a.dbc", tmp_path / "b.kcd")
    for file in files:
        file.write_text("")
    used = ChannelMap("old.toml", {}, databases=dict.fromkeys(buses, files))
    empty = Suggestion("x.blf", (), (), {}, {}, ())
    written = tmp_path / "map.toml"
    written.write_text(to_toml(empty, used, tmp_path) + '[channels.v]\nsource = "speed"\n')
    assert read_channel_map(written).databases == used.databases


@pytest.mark.parametrize("address", ["Zeit", "Zeit [s]"])
@pytest.mark.parametrize("columns", [with_gap("Zeit", 300), with_values("Zeit", -TIME)])
def test_a_time_of_the_user_that_is_no_clock_is_a_doubt(columns, address):
    result = suggestion(columns, user_specified={"time": address})
    assert [doubt.channel for doubt in result.doubts] == ["time"]
    assert "time" not in {proposal.channel for proposal in result.proposals}


def test_mirrored_wheels_get_a_sign():
    columns = foreign()
    for name in ("VR", "HR"):
        columns[f"nRad_{name}", "U/min"] = -columns[f"nRad_{name}", "U/min"]
    signs = {w: proposals_of(columns)[f"omega_{w}"].mapping.sign for w in WHEELS}
    assert signs == {"fl": 1, "fr": -1, "rl": 1, "rr": -1}


@pytest.mark.parametrize(
    ("wheel", "names"),
    [
        ("fl", ["omega_fl", "nRad_VL", "speed_lf", "front_l", "WhlSpdFrntLe"]),
        ("fr", ["WheelSpeedFR", "Rad_VoRe"]),
        ("rl", ["WhlSpd_RL_Meas", "wheel speed, left rear", "WhlSpdReLe", "Rad_HiLi"]),
        ("rr", ["Raddrehzahl hinten rechts", "Rear-Right Wheel", "ESP_HR_Radgeschw_02"]),
        (None, ["Front Axle Left Wheel", "velocity", "frontal area", "omega_rear", "l r"]),
    ],
)
def test_wheel_of(wheel, names):
    """Parts of a corner that are not beside each other are not certain."""
    assert {name: wheel_of(name) for name in names} == dict.fromkeys(names, wheel)


def test_split_wheel():
    assert [split_wheel(x) for x in ("WSFL", "Speed")] == [("fl", "ws"), (None, "speed")]


@pytest.mark.parametrize(
    ("quantity", "names", "others"),
    [
        ("speed", ["GW1_FzgGeschw", "vFzg", "VehSpdEsc", "CarSpeed"], ["v_Soll", "WhlSpd"]),
        ("longitudinal", ["LongAcc", "ESP_Laengsbeschl", "VehALgt"], ["LatAcc", "ESP_Querbeschl"]),
        ("brake", ["ESP_Bremsdruck"], []),
        ("master", ["pTHZ", "pVordruck"], []),
        ("steering", ["LWI_Lenkradwinkel", "StrgAg"], []),
    ],
)
def test_names_of_vehicle_buses(quantity, names, others):
    assert min(score(name, quantity) for name in names) > 0
    assert all(score(name, quantity) < 1 for name in others)
