"""Frames by identifier, whatever their order, length and bus."""

import can
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from calib.logs.bus.dbc import Dbc
from calib.logs.bus.recording import Gathered

frames = st.tuples(
    st.integers(0, 3), st.booleans(), st.sampled_from(["a", "b"]), st.binary(max_size=8)
)


@given(st.lists(frames, max_size=40))
def test_every_known_frame_is_kept_once_and_whole(rows):
    messages = [
        can.Message(timestamp=float(i), arbitration_id=a, is_extended_id=x, channel=b, data=d)
        for i, (a, x, b, d) in enumerate(rows)
    ]
    known = dict.fromkeys([(0, False), (1, True), (2, False)], "a message")
    found = Gathered(Dbc({"": known}))
    found.take(messages)
    assert len(found.times) == len(rows)
    kept = []
    for item in found.result(np.asarray(found.times)):
        for t, data, length in zip(item.time, item.data, item.length, strict=True):
            assert not data[length:].any()
            kept.append((t, *item.key, item.bus, bytes(data[:length])))
    expected = [(float(i), *row) for i, row in enumerate(rows) if row[:2] in known]
    assert sorted(kept) == sorted(expected)
