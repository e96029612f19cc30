"""Frames by identifier, whatever their order, length and bus."""

import can
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.logs.bus.frames import Gathered, frames_of, once

frames = st.tuples(
    st.integers(0, 3), st.booleans(), st.sampled_from(["a", "b"]), st.binary(max_size=8)
)


@given(st.lists(frames, max_size=40))
def test_every_known_frame_is_kept_once_and_whole(rows):
    messages = [
        can.Message(timestamp=float(i), arbitration_id=a, is_extended_id=x, channel=b, data=d)
        for i, (a, x, b, d) in enumerate(rows)
    ]
    known = frozenset([(0, False), (1, True), (2, False)])
    found = Gathered(lambda _, key: key in known)
    found.take(messages)
    assert len(found.times) == len(rows)
    kept = []
    for item in found.result(np.asarray(found.times)):
        for t, data, length in zip(item.time, item.data, item.length, strict=True):
            assert not data[length:].any()
            kept.append((t, *item.key, item.bus, bytes(data[:length])))
    expected = [(float(i), *row) for i, row in enumerate(rows) if row[:2] in known]
    assert sorted(kept) == sorted(expected)


@pytest.mark.parametrize("late", [0.0, 5e-5, 3e-4, 2e-3])
def test_a_message_recorded_twice_is_taken_once(late):
    time = np.arange(100) / 100
    rows = [bytes([i // 7, 1]) for i in range(100)]  # some in a row are alike, as at a standstill
    twice = frames_of(
        "0", (1, False), np.concatenate([time, time + late]), rows + rows, np.arange(200)
    )
    ((single,), (note,)) = once([twice])
    np.testing.assert_array_equal(single.time, time)
    assert "100 of 200" in note


def test_what_is_sent_often_is_no_double():
    constant = frames_of("0", (1, False), np.arange(100) / 100, [b"\1"] * 100)
    bursts = np.sort(np.concatenate([np.arange(50) / 50, np.arange(50) / 50 + 1e-4]))
    other = frames_of("0", (2, False), bursts, [bytes([i]) for i in range(100)])
    assert once([constant, other]) == ([constant, other], [])
