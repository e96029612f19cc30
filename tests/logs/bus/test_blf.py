"""BLF: what its header and its containers state is there, or the file is refused."""

import struct
import zlib

import can
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.logs.bus.blf import check_whole, open_blf
from calib.logs.channel_map import DatabaseFile, Databases
from calib.logs.read import read_log
from tests.support.blf import HEADER, RESTORE, blf, block, container, frame, header
from tests.support.recordings import messages, ramp, write_bus
from tests.support.refusals import refusal


@pytest.fixture(scope="module")
def folder(bus):
    """A whole BLF file, `whole.blf`, and its map."""
    write_bus(bus / "whole.blf", 1.7e9)
    return bus


def refused(folder, data, name="cut.blf"):
    path = folder / name
    path.write_bytes(data)
    return refusal(read_log, path, folder / "map.toml", kind=LogError)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(share=st.floats(0.0, 1.0, exclude_max=True))
def test_a_file_cut_anywhere_is_refused(folder, share):
    data = (folder / "whole.blf").read_bytes()
    left = int(share * len(data))
    message = refused(folder, data[:left])
    if left >= 144:
        assert f"{len(data) - left} are missing" in message


def test_the_library_reads_half_a_file_in_silence(folder):
    """What the gate is for; should python-can begin to say so, this test tells."""
    write = can.BLFWriter(folder / "many.blf", max_container_size=8192)
    with write as log:
        for message in messages(1.7e9):
            log.on_message_received(message)
    data = (folder / "many.blf").read_bytes()
    cut = data.index(b"LOBJ", len(data) // 2)  # where a container ends
    (folder / "half.blf").write_bytes(data[:cut])
    with can.BLFReader(folder / "half.blf") as reader:
        assert 1000 < sum(1 for _ in reader) < len(messages(1.7e9)) - 1000
    assert f"{len(data) - cut} are missing" in refused(folder, data[:cut])


def test_a_header_that_was_mended_does_not_hide_lost_objects(folder):
    data = (folder / "many.blf").read_bytes()
    cut = data.index(b"LOBJ", len(data) // 2)
    mended = data[:16] + struct.pack("<Q", cut) + data[24:cut]
    message = refused(folder, mended)
    assert f"of {len(messages(1.7e9))} objects:" in message


def test_a_recorder_that_did_not_finish(folder):
    data = (folder / "whole.blf").read_bytes()
    assert "did not finish" in refused(folder, data[:16] + bytes(20) + data[36:])


def test_a_container_that_cannot_be_unpacked(folder):
    data = bytearray((folder / "whole.blf").read_bytes())
    for place in range(300, 340):
        data[place] ^= 0xFF
    assert "unpacked" in refused(folder, bytes(data)) or "objects:" in refused(folder, bytes(data))


SHORT_HEADER = struct.pack("<4sL8xQQL", b"LOGG", 36, 36, 36, 1)
"""Its sizes are right, and the times of start and end are missing."""


@pytest.mark.parametrize("data", [b"", b"LOGG", b"time [s],p_mc [bar]\n" * 20, SHORT_HEADER])
def test_what_is_no_blf(folder, data):
    assert "not a BLF file" in refused(folder, data)


def test_other_objects_are_counted_but_are_no_frames(folder):
    """A marker, an error frame and a remote frame between the frames."""
    path = folder / "more.blf"
    with can.BLFWriter(path) as log:
        for number, message in enumerate(messages(1.7e9)):
            log.on_message_received(message)
            if number == 100:
                log.log_event("brakes on", message.timestamp)
                log.on_message_received(
                    can.Message(timestamp=message.timestamp, is_error_frame=True)
                )
                log.on_message_received(
                    can.Message(
                        timestamp=message.timestamp,
                        arbitration_id=256,
                        is_extended_id=False,
                        is_remote_frame=True,
                    )
                )
    assert check_whole(path) == (len(messages(1.7e9)) + 2, ())
    log = read_log(path, folder / "map.toml")
    assert "1 error frames were ignored" in log.notes
    whole = read_log(folder / "whole.blf", folder / "map.toml")
    np.testing.assert_array_equal(log["omega_fl"], whole["omega_fl"])


def test_a_clock_of_32_bits_that_wraps(folder):
    """A recorder that counts microseconds in 32 bits and begins 3 s before they are full.

    One container is taken apart and put together anew; the time lies 24 bytes into an object.
    """
    with can.BLFWriter(folder / "one.blf", max_container_size=10**7) as log:
        for message in messages(1.7e9):
            log.on_message_received(message)
    data = (folder / "one.blf").read_bytes()
    objects, place = bytearray(zlib.decompress(data[144 + 32 :])), 0
    while (place := objects.find(b"LOBJ", place)) >= 0:
        (time,) = struct.unpack_from("<Q", objects, place + 24)
        counted = (time // 1000 + 2**32 - 3_000_000) % 2**32
        struct.pack_into("<Q", objects, place + 24, counted * 1000)
        place += 32
    packed = zlib.compress(objects)
    container = data[144:152] + struct.pack("<L", 32 + len(packed)) + data[156:176] + packed
    container += bytes(len(container) % 4)
    size = struct.pack("<Q", 144 + len(container))
    (folder / "wrapped.blf").write_bytes(data[:16] + size + data[24:144] + container)
    log = read_log(folder / "wrapped.blf", folder / "map.toml")
    whole = read_log(folder / "whole.blf", folder / "map.toml")
    assert any("32 bits of microseconds" in note for note in log.notes)
    np.testing.assert_allclose(log.time, whole.time, atol=2e-6)
    assert log.time[-1] == pytest.approx(ramp().time[-1], abs=0.02)


def vector(**more):
    """Frames at 100 Hz as Vector's writers store them: two objects of type 115 are not counted."""
    rows = b"".join(frame(0.01 * i, 256, bytes([0, i % 200] * 4)) for i in range(300))
    ends = b"".join(block(RESTORE, bytes(42)) for _ in range(2))
    half = 150 * 48 + 20  # an object continues in the next container
    return blf([rows[:half], rows[half:], ends], 300, **more)


@pytest.mark.parametrize("compressed", [False, True])
def test_objects_that_the_writer_does_not_count(folder, compressed):
    """Six of six files of Vector's programs in the tests of python-can are like this."""
    path = folder / "vector.blf"
    path.write_bytes(vector(compressed=compressed))
    assert check_whole(path)[0] == 300
    opened = open_blf(path, Databases((DatabaseFile(folder / "chassis.dbc"),)))
    (wheel,) = opened.read([1])
    np.testing.assert_allclose(wheel.time, 0.01 * np.arange(300), atol=5e-7)
    np.testing.assert_allclose(wheel.values, 0.005 * (np.arange(300) % 200))
    assert any("counts 300 objects, the file has 302" in note for note in opened.notes)


@pytest.mark.parametrize("compressed", [False, True])
def test_a_lost_container_shows_in_the_unpacked_size(folder, compressed):
    parts = [frame(0.01 * i, 256, bytes(8)) for i in range(3)]
    body = b"".join(container(part, compressed) for part in parts[:2])
    message = refused(folder, header(len(body), parts, 2) + body)
    assert "of 384 bytes (unpacked) and 2 of 2 objects" in message


def test_without_an_unpacked_size_the_count_decides(folder):
    whole = blf([frame(0.0, 256, bytes(8))], 1, unpacked=0)
    (folder / "plain.blf").write_bytes(whole)
    assert check_whole(folder / "plain.blf") == (1, ())
    cut = blf([frame(0.0, 256, bytes(8))], 3, unpacked=0)
    assert "the file has 1 of 3 objects: some are missing" in refused(folder, cut)


def test_padding_may_be_counted_or_not(folder):
    part = block(65, bytes(19)) + frame(0.0, 256, bytes(8))
    for unpacked in (None, HEADER + 32 + len(part) + (32 + len(part)) % 4):
        (folder / "padded.blf").write_bytes(blf([part], 2, unpacked=unpacked))
        assert check_whole(folder / "padded.blf") == (1, ())


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (container(frame(0.0, 256, bytes(8)), stated=90), "it holds 48 of 90 bytes"),
        (container(frame(0.0, 256, bytes(8)) + block(1, bytes(20), 48)), "after 1 whole ones"),
        (container(frame(0.0, 256, bytes(8)) + b"x" * 40), "no object after 1 whole ones"),
        (container(block(1, b"", 4)), "an object of 4 bytes"),
        (block(10, b"\2\0"), "it has no header"),
    ],
    ids=["content", "object", "no object", "size", "head"],
)
def test_what_is_not_whole_inside_a_container(folder, body, words):
    assert words in refused(folder, header(len(body), [], 1, unpacked=HEADER) + body)


def test_a_compressed_container_that_ends_early(folder):
    content = b"".join(frame(0.01 * i, 256, bytes([i] * 8)) for i in range(50))
    packed = zlib.compress(content)[:-30]
    body = block(10, struct.pack("<H6xL4x", 2, len(content)) + packed)
    message = refused(folder, header(len(body), [content], 50) + body)
    assert "cannot be unpacked: it ends after" in message
