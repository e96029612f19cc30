"""PEAK TRC: values as in the log of candump; a line that is damaged or cut off is refused."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.bus.text_logs import open_text_log
from calib.logs.read import read_log
from tests.support.recordings import messages
from tests.support.refusals import refusal
from tests.support.trc import HEADS, trc

VERSIONS = list(HEADS)


@pytest.fixture(scope="module")
def texts():
    return {version: trc(version, messages()) for version in VERSIONS}


def open_trc(bus_folder, text, name="run.trc"):
    path = bus_folder / name
    path.write_text(text)
    return open_text_log(path, {"": (bus_folder / "chassis.dbc",)})


def refusal_of(bus_folder, text):
    return refusal(open_trc, bus_folder, text, kind=LogError, names="run.trc")


@pytest.mark.parametrize("version", VERSIONS)
def test_frames_are_those_of_the_run(bus_folder, texts, version):
    recording = open_trc(bus_folder, texts[version])
    index = [c.name for c in recording.columns].index("PMc")
    (pressure,) = recording.read([index])
    sent = [m for m in messages() if m.is_extended_id and m.data[0] & 3 == 1]
    raw = np.asarray([int.from_bytes(m.data[:3], "little") >> 4 & 0xFFFF for m in sent])
    np.testing.assert_array_equal(pressure.values, raw - 500.0)
    begin = min(m.timestamp for m in messages() if version >= "2" or not m.is_fd)
    tick = {"1.0": 1e-3, "1.1": 1e-4}.get(version, 1e-6)
    np.testing.assert_allclose(pressure.time, [m.timestamp - begin for m in sent], atol=1.1 * tick)


def test_a_log_with_fd_frames(bus_folder, texts):
    (bus_folder / "run.trc").write_text(texts["2.1"])
    log = read_log(bus_folder / "run.trc", bus_folder / "map.toml")
    whole = read_log(bus_folder / "whole.log", bus_folder / "map.toml")
    for name in ("omega_fl", "p_mc", "a_x", "v"):
        np.testing.assert_allclose(log[name], whole[name], rtol=1e-4, atol=1e-9)


DAMAGE = {
    "type": lambda row: row.replace("Rx", "Qx").replace("DT", "DQ").replace("FB", "FQ"),
    "data": lambda row: row.rstrip().rsplit(maxsplit=1)[0] + "\n",
    "text": lambda row: row.rstrip()[:-1] + "*\n",
    "half": lambda row: row[:17] + "\n",
}


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_line(bus_folder, texts, version, damage):
    if (version, damage) == ("1.0", "type"):
        pytest.skip("it has no types")
    lines = texts[version].splitlines(keepends=True)
    lines[300] = DAMAGE[damage](lines[300])
    refusal_of(bus_folder, "".join(lines))


@pytest.mark.parametrize("version", VERSIONS)
def test_a_last_line_that_is_cut_off(bus_folder, texts, version):
    """A last line without an end of line is whole: PEAK-Converter writes none."""
    lines = texts[version].splitlines(keepends=True)[:301]
    count = len(open_trc(bus_folder, "".join(lines[:300])).read([1])[0].time)
    text = "".join(lines)
    assert len(open_trc(bus_folder, text[:-1]).read([1])[0].time) in (count, count + 1)
    for cut in (2, 7, 13):
        refusal_of(bus_folder, text[:-cut])
