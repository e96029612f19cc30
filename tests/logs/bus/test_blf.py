"""BLF: what its header and its containers state is there, or the file is refused."""

import struct
import zlib

import can
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from calib.logs.bus.blf import open_blf
from calib.logs.read import read_log
from tests.support.blf import HEADER, RESTORE, blf, block, container, frame, header
from tests.support.recordings import messages


@pytest.fixture(scope="module")
def containers(bus_folder):
    """A file of several containers, and the byte where one in its middle begins."""
    with can.BLFWriter(bus_folder / "many.blf", max_container_size=8192) as log:
        for message in messages(1.7e9):
            log.on_message_received(message)
    data = (bus_folder / "many.blf").read_bytes()
    return data, data.index(b"LOBJ", len(data) // 2)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(share=st.floats(0.0, 1.0, exclude_max=True))
def test_a_file_cut_anywhere_is_refused(refused_bus, containers, share):
    """Also where a container ends: python-can reads such a half in silence."""
    data, end = containers
    for size in (int(share * len(data)), end):
        message = refused_bus("cut.blf", data[:size])
        assert size < HEADER or f"{len(data) - size} are missing" in message


def mended(data, end):
    """The header has the size of what is left."""
    return data[:16] + struct.pack("<Q", end) + data[24:end]


def unfinished(data, _):
    return data[:16] + bytes(20) + data[36:]


def flipped(data, _):
    return data[:300] + bytes(byte ^ 0xFF for byte in data[300:340]) + data[340:]


@pytest.mark.parametrize("damage", [mended, unfinished, flipped])
def test_a_damaged_file_is_refused(refused_bus, containers, damage):
    refused_bus("cut.blf", damage(*containers))


def test_other_objects_are_counted_but_are_no_frames(bus_folder):
    """A marker, an error frame and a remote frame between the frames."""
    path, frames = bus_folder / "more.blf", messages(1.7e9)
    stamp = frames[100].timestamp
    remote = {"arbitration_id": 256, "is_extended_id": False, "is_remote_frame": True}
    with can.BLFWriter(path) as log:
        for number, message in enumerate(frames):
            log.on_message_received(message)
            if number == 100:
                log.log_event("brakes on", stamp)
                log.on_message_received(can.Message(timestamp=stamp, is_error_frame=True))
                log.on_message_received(can.Message(timestamp=stamp, **remote))
    log = read_log(path, bus_folder / "map.toml")
    assert "1 error frames were ignored" in log.notes
    whole = read_log(bus_folder / "whole.blf", bus_folder / "map.toml")
    np.testing.assert_array_equal(log["omega_fl"], whole["omega_fl"])


def vector(**more):
    """Frames at 100 Hz as Vector's writers store them: two objects of type 115 are not counted."""
    rows = b"".join(frame(0.01 * i, 256, bytes([0, i % 200] * 4)) for i in range(300))
    ends = b"".join(block(RESTORE, bytes(42)) for _ in range(2))
    half = 150 * 48 + 20  # an object continues in the next container
    return blf([rows[:half], rows[half:], ends], 300, **more)


def first_wheel(bus_folder, data):
    path = bus_folder / "made.blf"
    path.write_bytes(data)
    return open_blf(path, {"": (bus_folder / "chassis.dbc",)}).read([1])[0]


@pytest.mark.parametrize("compressed", [False, True])
def test_objects_that_the_writer_does_not_count(bus_folder, compressed):
    """Six of six files of Vector's programs in the tests of python-can are like this."""
    wheel = first_wheel(bus_folder, vector(compressed=compressed))
    np.testing.assert_allclose(wheel.time, 0.01 * np.arange(300), atol=5e-7)
    np.testing.assert_allclose(wheel.values, 0.005 * (np.arange(300) % 200))


ONE = frame(0.0, 256, bytes(8))


def two_of_three(compressed):
    """A file that states three frames, each in its container, and holds two."""
    body = b"".join(container(ONE, compressed) for _ in range(2))
    return header(len(body), [ONE] * 3, 2) + body


def with_body(body):
    return header(len(body), [], 1, unpacked=HEADER) + body


def ends_early():
    content = b"".join(frame(0.01 * i, 256, bytes([i] * 8)) for i in range(50))
    body = block(10, struct.pack("<H6xL4x", 2, len(content)) + zlib.compress(content)[:-30])
    return header(len(body), [content], 50) + body


REFUSED = {
    "no times in the header": (struct.pack("<4sL8xQQL", b"LOGG", 36, 36, 36, 1), "BLF"),
    "no unpacked size": (blf([ONE], 1, unpacked=0), "did not finish"),
    "lost container": (two_of_three(False), "384 bytes"),
    "lost, packed": (two_of_three(True), "384 bytes"),
    "content": (with_body(container(ONE, declared=90)), "48 of 90 bytes"),
    "a frame of no size": (with_body(container(ONE[:8] + bytes(4) + ONE[12:])), "more frames"),
    "packed content": (ends_early(), "unpacked"),
    "unknown method": (with_body(block(10, struct.pack("<H6xL4x", 7, 48) + ONE)), ", 7,"),
    "an object beyond the end": (
        with_body(container(ONE) + block(RESTORE, bytes(8), size=600)), "damaged near",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("data", "says"), REFUSED.values(), ids=REFUSED)
def test_what_is_not_whole(refused_bus, data, says):
    assert says in refused_bus("cut.blf", data)
