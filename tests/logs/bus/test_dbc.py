"""Signals of a DBC: what cantools decodes frame by frame, and what is no measurement."""

import logging
import warnings

import cantools
import numpy as np
import pytest

from calib.base.errors import ChannelMapError, LogError
from calib.logs.bus.dbc import read_databases
from calib.logs.bus.recording import decode, described_signals, frames_of
from tests.support.databases import SAMPLES
from tests.support.recordings import DBC

MUX = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 1 M: 8 A
 SG_ Top M : 7|2@0+ (1,0) [0|3] "" A
 SG_ Low m1M : 5|2@0+ (1,0) [0|3] "" A
 SG_ Deep m2 : 15|12@0- (0.5,3) [0|0] "bar" A
 SG_ Flat m3 : 16|12@1- (0.25,-1) [0|0] "bar" A
 SG_ Gear : 56|3@1+ (1,0) [0|7] "" A
 SG_ Speed : 32|8@1+ (0.5,0) [0|127] "km/h" A
SG_MUL_VAL_ 1 Low Top 1-1;
SG_MUL_VAL_ 1 Deep Low 2-2;
SG_MUL_VAL_ 1 Flat Top 3-3;
VAL_ 1 Gear 0 "N" 1 "1" 2 "2" 3 "3" 4 "4" 5 "5" 6 "6" 7 "R" ;
VAL_ 1 Speed 255 "SNA" ;
"""


def database_of(tmp_path, text, name="a.dbc"):
    path = tmp_path / name
    path.write_text(text)
    return read_databases({"": [path]}, "can", "run.blf")


def decoded(dbc, name, data):
    message = dbc.buses[""][1, False]
    frames = frames_of("0", (1, False), np.arange(float(len(data))), data)
    return decode(frames, message, message.get_signal_by_name(name))


@pytest.fixture
def rows():
    rng = np.random.default_rng(3)
    return [bytes(row) for row in rng.integers(0, 255, (600, 8), np.uint8) if selects(row[0])]


def selects(byte):
    """Whether the multiplexers of a frame have a value that the DBC knows."""
    top, low = byte >> 6, byte >> 4 & 3
    return top == 3 or (top, low) == (1, 2)


@pytest.mark.parametrize("name", ["Top", "Low", "Deep", "Flat", "Gear", "Speed"])
def test_nested_multiplexers_are_those_of_cantools(tmp_path, rows, name):
    reference = cantools.database.load_string(MUX, "dbc").get_message_by_name("M")
    expected = []
    for time, row in enumerate(rows):
        signals = reference.decode(row, decode_choices=False, allow_truncated=True)
        if name in signals and not (name == "Speed" and row[4] == 255):
            expected.append((time, signals[name]))
    trace = decoded(database_of(tmp_path, MUX), name, rows)
    is_valid = ~np.isnan(trace.values)
    assert len(expected) > 5
    np.testing.assert_array_equal(trace.time[is_valid], [t for t, _ in expected])
    np.testing.assert_allclose(trace.values[is_valid], [x for _, x in expected], rtol=1e-15)


def test_names_of_values_and_short_frames(tmp_path, rows):
    """A signal whose values all have names is a state; "SNA" is NaN; a short frame has no value."""
    dbc = database_of(tmp_path, MUX)
    states = [name for name in ("Gear", "Speed", "Deep") if decoded(dbc, name, rows).is_state]
    assert states == ["Gear"]
    trace = decoded(dbc, "Speed", [b"\0\0\0\0\xfe\0\0\0", b"\xff" * 8, bytes(4), bytes(5)])
    np.testing.assert_array_equal(trace.time, [0.0, 1.0, 3.0])
    np.testing.assert_array_equal(trace.values, [127.0, np.nan, 0.0])


A_TEXT = 'CM_ "{}";\n'


@pytest.mark.parametrize(
    "text",
    [
        "",
        "BO_ 1 M: 8\n",
        "\0\1\2",
        *(DBC + A_TEXT.format(part * 400_000) for part in ("aaa", 'a\\"')),
    ],
    ids=["empty", "no messages", "bytes", "text without end", "escapes without end"],
)
def test_what_is_no_dbc(tmp_path, text):
    """A text that never ends is refused before it costs memory."""
    with pytest.raises(ChannelMapError):
        database_of(tmp_path, text)


def test_files_that_describe_one_frame_or_are_not_there(tmp_path):
    for name in ("a.dbc", "b.dbc"):
        (tmp_path / name).write_text(MUX)
    for names in (["a.dbc", "b.dbc"], ["c.dbc"]):
        with pytest.raises(ChannelMapError):
            read_databases({"": [tmp_path / name for name in names]}, "can", "run.blf")


OTHER = "BO_ 9 OTHER: 2 A\n"
SIGNAL = ' SG_ B : 0|8@1+ (1,0) [0|0] "bar" A\n'


@pytest.mark.parametrize(
    "flaw",
    [
        OTHER + SIGNAL + ' SG_ C : 4|8@1+ (1,0) [0|0] "" A\n',
        OTHER + ' SG_ B : 12|8@1+ (1,0) [0|0] "" A\n',
        OTHER + ' SG_ B : 0|0@1+ (1,0) [0|0] "" A\n',
        OTHER + ' SG_ 2B : 0|8@1+ (1,0) [0|0] "" A\n',
        OTHER + ' SG_ B : 0|8@1+ (1,0) [0|0] "" A\nrubbish\n',
        OTHER + ' SG_ B : 0|8@1+ (1,0) [0|0] "no end A\n',
        "BO_ 9 4WD: 2 A\n" + SIGNAL,
        OTHER + SIGNAL + "BO_ 9 AGAIN: 2 A\n" + SIGNAL,
        OTHER + SIGNAL + 'VAL_ 9 B 0 "none ;\n',
    ],
)
def test_a_flaw_costs_its_message(tmp_path, flaw):
    """Signals that overlap, lie outside or are empty; wrong names and signs; a second message."""
    dbc = database_of(tmp_path, MUX + flaw)
    assert decoded(dbc, "Speed", [bytes([0, 0, 0, 0, 254, 0, 0, 0])]).values[0] == 127.0
    assert len(dbc.notes) == 2
    columns, places = described_signals([frames_of("0", (9, False), np.zeros(1), [bytes(2)])], dbc)
    assert columns
    with pytest.raises(LogError, match=r"4WD|OTHER"):
        decode(*places[0])


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_the_encodings_of_a_dbc(tmp_path, encoding):
    path = tmp_path / "a.dbc"
    path.write_bytes(MUX.replace("km/h", "m/s²").encode(encoding))
    dbc = read_databases({"": [path]}, "can", "run.blf")
    assert dbc.buses[""][1, False].get_signal_by_name("Speed").unit == "m/s²"


def test_names_of_more_than_32_characters(tmp_path):
    long = "S" * 40
    text = (
        MUX.replace("SG_ Speed", f"SG_ {long[:32]}").replace(" Speed ", f" {long[:32]} ")
        + 'BA_DEF_ SG_ "SystemSignalLongSymbol" STRING ;\n'
        + f'BA_ "SystemSignalLongSymbol" SG_ 1 {long[:32]} "{long}";\n'
    )
    assert database_of(tmp_path, text).buses[""][1, False].get_signal_by_name(long).unit == "km/h"


FRAMES = 30


def canmatrix_frames(path):
    """Frames of canmatrix by identifier."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import canmatrix.formats

        logging.getLogger("canmatrix").setLevel(logging.CRITICAL)
        matrices = canmatrix.formats.loadp(str(path))
    return {
        (frame.arbitration_id.id, bool(frame.arbitration_id.extended)): frame
        for matrix in matrices.values()
        for frame in matrix.frames
    }


def random_frames(key, length):
    rows = np.random.default_rng(key[0]).integers(0, 256, (FRAMES, length), np.uint8)
    data = [bytes(row) for row in rows]
    return data, frames_of("0", key, np.arange(float(FRAMES)), data)


def values_by_frame(frames, message, signal):
    """Value by number of the frame."""
    trace = decode(frames, message, signal)
    return dict(zip(trace.time.astype(int).tolist(), trace.values.tolist(), strict=True))


@pytest.mark.parametrize("path", sorted(SAMPLES.glob("*.*[dkx][bcm][cdl]")), ids=lambda p: p.name)
def test_signals_are_those_of_another_reader(path):
    matrix, count = canmatrix_frames(path), 0
    for key, message in read_databases({"": [path]}, "can", "x").buses[""].items():
        data, frames = random_frames(key, message.length)
        decoded = [matrix[key].decode(row) for row in data]
        for signal in message.signals:
            expected = {i: float(row[signal.name].phys_value) for i, row in enumerate(decoded)
                        if signal.name in row}  # fmt: skip
            values = values_by_frame(frames, message, signal)
            assert values.keys() == expected.keys(), signal.name
            np.testing.assert_allclose(
                [values[i] for i in expected], list(expected.values()), rtol=1e-12, equal_nan=True
            )
            count += len(expected)
    assert count >= 20
