"""Signals out of bytes, against cantools, which decodes one frame at a time."""

import numpy as np
from cantools.database.can import Message, Signal
from cantools.database.conversion import BaseConversion
from hypothesis import given
from hypothesis import strategies as st

from calib.logs.bus.recording import number, raw

WIDTH = 12


def theirs(rows, start, length, little, signed, real):
    order = "little_endian" if little else "big_endian"
    conversion = BaseConversion.factory(is_float=real)
    signal = Signal("s", start, length, order, signed, conversion=conversion)
    message = Message(1, "m", WIDTH, [signal], strict=True)
    return [message.decode(bytes(row), scaling=False)["s"] for row in rows]


LENGTHS = st.integers(1, 64)


@st.composite
def places(draw, lengths=LENGTHS):
    """A start and a length that a frame can hold, by the order of the bytes."""
    little, length = draw(st.booleans()), draw(lengths)
    first = draw(st.integers(0, 8 * WIDTH - length))  # bits before it, counted as they are sent
    return first if little else 8 * (first // 8) + 7 - first % 8, length, little


rows = st.lists(st.binary(min_size=WIDTH, max_size=WIDTH), min_size=1, max_size=5)
integers = st.tuples(places(), st.booleans(), st.just(False))
floats = st.tuples(places(st.sampled_from([16, 32, 64])), st.just(True), st.just(True))


@given(rows, st.one_of(integers, floats))
def test_numbers_are_those_of_cantools(rows, form):
    (start, length, little), signed, real = form
    data = np.frombuffer(b"".join(rows), np.uint8).reshape(len(rows), WIDTH)
    with np.errstate(invalid="ignore"):  # a signalling NaN
        found = number(raw(data, start, length, little), length, signed, real)
    expected = np.asarray(theirs(rows, start, length, little, signed, real), float)
    np.testing.assert_array_equal(found, expected)
