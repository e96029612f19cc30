"""J1939 messages of several frames, as another program sent them and by the rules of J1939-21."""

import numpy as np
import pytest

from calib.errors import LogError
from calib.logs.bus.candump import open_candump
from calib.logs.bus.databases import DatabaseFile, Databases
from calib.logs.bus.dbc import Dbc, read_dbc
from calib.logs.bus.frames import frames_of
from calib.logs.bus.transport import put_together

DBC = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 256 Plain: 8 A
 SG_ Level : 0|8@1+ (1,0) [0|0] "%" A
BO_ 2566843646 VI: 17 A
 SG_ First : 0|8@1+ (1,0) [0|255] "" A
 SG_ Last : 128|8@1+ (1,0) [0|255] "" A
BO_ 2565800190 PropA: 20 A
 SG_ Sixth : 40|8@1+ (1,0) [0|255] "" A
 SG_ End : 152|8@1+ (1,0) [0|255] "" A
"""
"""Groups 65260 and 61184 (SAE J1939-71), both longer than a frame."""

SENT = [
    "18ECFF0B#20110003FFECFE00", "1CEBFF0B#015756575A5A5A31", "1CEBFF0B#024A5A5857303030",
    "1CEBFF0B#03303031FFFFFFFF", "18EC210B#101400030100EF00", "1CEC0B21#110101FFFF00EF00",
    "1CEB210B#0101020304050607", "1CEC0B21#110102FFFF00EF00", "1CEB210B#0208090A0B0C0D0E",
    "1CEC0B21#110103FFFF00EF00", "1CEB210B#030F1011121314FF", "1CEC0B21#13140003FF00EF00",
]  # fmt: skip
"""Two units of can-j1939 2.0.12: 17 bytes of group 65260 to all, 20 bytes of 61184 to 0x21."""

VI, PROP_A = SENT[:4], SENT[4:]
WHOLE = "several frames were put together"
LOST = "lack one of their frames were left out"


def opened(folder, frames, sources=(), step=0.05):
    """A log of these frames, one every ``step`` [s] or at a stated time, and of a plain one."""
    rows = [(i * step, f) if isinstance(f, str) else f for i, f in enumerate(frames)]
    plain = [(0.01 * i, f"100#{i:02X}00000000000000") for i in range(60)]
    lines = [f"({t:.6f}) can0 {f}\n" for t, f in sorted([*plain, *rows], key=lambda row: row[0])]
    (folder / "long.dbc").write_text(DBC)
    (folder / "run.log").write_text("".join(lines))
    databases = Databases((DatabaseFile(folder / "long.dbc"),), (), sources)
    return open_candump(folder / "run.log", databases)


def values(found):
    """Values of the signals of the long messages by their names, and the time of the last one."""
    names = [column.full for column in found.columns[1:]]
    traces = found.read(range(1, len(names) + 1))
    return {n: x for n, x in zip(names, traces, strict=True) if not n.startswith("Plain")}


def notes(found):
    return " | ".join(found.notes)


def test_what_another_program_sent_is_read(tmp_path):
    """To all, and to one address that clears each frame; they count from their announcement."""
    found = opened(tmp_path, SENT)
    traces = values(found)
    told = {name: trace.values.tolist() for name, trace in traces.items()}
    assert told == {
        "VI.First": [ord("W")], "VI.Last": [ord("1")], "PropA.Sixth": [6.0], "PropA.End": [20.0],
    }  # fmt: skip
    assert traces["VI.First"].time.tolist() == [0.0]
    assert traces["PropA.End"].time.tolist() == pytest.approx([0.2])
    assert f"{WHOLE}: 1 x PropA, 1 x VI" in notes(found)
    assert LOST not in notes(found)


@pytest.mark.parametrize("missing", [1, 2, 3])
def test_a_message_that_lacks_a_frame_is_left_out_and_told(tmp_path, missing):
    found = opened(tmp_path, [*VI[:missing], *VI[missing + 1 :], *PROP_A])
    assert set(values(found)) == {"PropA.Sixth", "PropA.End"}
    assert f"{WHOLE}: 1 x PropA" in notes(found)
    assert f"{LOST}: 1 x VI" in notes(found)


def test_a_lost_announcement_gives_no_message_and_mixes_none(tmp_path):
    """Frame 3 of the first is lost, and so is the announcement of the second."""
    found = opened(tmp_path, [*VI[:3], *VI[1:], *VI])
    assert values(found)["VI.Last"].values.tolist() == [ord("1")]
    assert f"{LOST}: 1 x VI" in notes(found)
    found = opened(tmp_path, [*VI[:2], (2.0, VI[2]), (2.05, VI[3])])
    assert values(found) == {}, "a pause of 2 s ends a message"


def test_a_frame_that_the_receiver_asks_for_again_counts(tmp_path):
    """J1939-21: CTS with next frame 2 after frame 3 went wrong; frames 2 and 3 come again."""
    again = "1CEC0B21#110202FFFF00EF00"
    spoilt = PROP_A[6].replace("0F1011121314", "AAAAAAAAAAAA")
    sent = [*PROP_A[:6], spoilt, again, PROP_A[4], PROP_A[6], PROP_A[7]]
    found = opened(tmp_path, sent)
    assert values(found)["PropA.End"].values.tolist() == [20.0]
    assert LOST not in notes(found)


def test_a_message_that_one_side_gives_up_is_left_out(tmp_path):
    """Abort by the receiver before the last frame, by J1939-21: 255, reason, group."""
    found = opened(tmp_path, [*VI, *PROP_A[:5], "1CEC0B21#FF03FFFFFF00EF00", PROP_A[6]])
    assert set(values(found)) == {"VI.First", "VI.Last"}
    assert f"{LOST}: 1 x PropA" in notes(found)


@pytest.mark.parametrize("stated", ["0000", "0800", "1100"])
def test_an_announcement_that_cannot_be_is_no_message(tmp_path, stated):
    """0 bytes, 8 bytes, and 17 bytes in 0 frames."""
    found = opened(tmp_path, [f"18ECFF0B#20{stated}00FFECFE00", *PROP_A])
    assert set(values(found)) == {"PropA.Sixth", "PropA.End"}
    assert f"{LOST}: 1 x VI" in notes(found)


def test_senders_and_destinations_are_kept_apart(tmp_path):
    """Two units send at once, one of them to all and to 0x21 at once."""
    other = [f.replace("FF0B#", "FF0C#") for f in VI]
    other[1] = other[1].replace("0157", "0158")
    mixed = [f for three in zip(VI, PROP_A[::2], other, strict=True) for f in three]
    found = opened(tmp_path, mixed, step=0.01)
    told = {name: trace.values.tolist() for name, trace in values(found).items()}
    assert told["VI@0B.First"] == [ord("W")]
    assert told["VI@0C.First"] == [ord("X")]
    assert f"{WHOLE}: 1 x PropA, 2 x VI" in notes(found)


def test_only_senders_that_the_map_names(tmp_path):
    found = opened(tmp_path, SENT, sources=(0x21,))
    assert values(found) == {}
    assert "J1939 messages" not in notes(found)
    assert values(opened(tmp_path, SENT, sources=None)) == {}


def test_frames_of_one_time_keep_the_order_of_the_file(tmp_path):
    """A recorder that counts in ms gives RTS, CTS and the frames one time."""
    found = opened(tmp_path, [(0.2, frame) for frame in SENT])
    assert f"{WHOLE}: 1 x PropA, 1 x VI" in notes(found)


def test_a_log_with_nothing_else_says_why(tmp_path):
    (tmp_path / "long.dbc").write_text(DBC)
    lines = [f"({0.1 * i:.6f}) can0 {f}\n" for i, f in enumerate(VI[:3])]
    (tmp_path / "run.log").write_text("".join(lines))
    with pytest.raises(LogError, match=rf"no frame of the log.*{LOST}: 1 x VI"):
        open_candump(
            tmp_path / "run.log", Databases((DatabaseFile(tmp_path / "long.dbc"),), (), ())
        )


def test_the_longest_message(tmp_path):
    """1785 bytes in 255 frames: the bytes come back as they were cut, 7 by 7."""
    (tmp_path / "long.dbc").write_text(DBC)
    files = (DatabaseFile(tmp_path / "long.dbc"),)
    known = Dbc(read_dbc(files, "can", "a").messages, (), {}, ())
    data = bytes(np.random.default_rng(1).integers(0, 256, 1785, dtype=np.uint8))
    head = bytes([32, 1785 & 255, 1785 >> 8, 255, 255, 0xEC, 0xFE, 0])
    cut = [bytes([i + 1]) + data[7 * i : 7 * i + 7] for i in range(255)]
    time = 0.05 * np.arange(256)
    frames = [
        frames_of("1", (0x1CEBFF0B, True), time[1:], cut, np.arange(1, 256)),
        frames_of("1", (0x18ECFF0B, True), time[:1], [head], np.array([0])),
    ]
    (made,), _ = put_together(frames, known)
    assert made.data[0].tobytes() == data
    assert made.length.tolist() == [1785]
    assert made.key == (0x18FEEC0B, True)
