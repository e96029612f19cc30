"""Signals out of bytes, against cantools, which decodes one frame at a time."""

import numpy as np
import pytest
from cantools.database.can import Message, Signal
from cantools.database.conversion import BaseConversion
from hypothesis import given
from hypothesis import strategies as st

from calib.logs.bus.recording import last_byte, number, raw

WIDTH = 12


def theirs(rows, start, length, little, signed, real):
    order = "little_endian" if little else "big_endian"
    conversion = BaseConversion.factory(is_float=real)
    signal = Signal("s", start, length, order, signed, conversion=conversion)
    message = Message(1, "m", WIDTH, [signal], strict=True)
    return [message.decode(bytes(row), scaling=False)["s"] for row in rows]


@st.composite
def places(draw):
    """A start and a length that a frame can hold, by the order of the bytes."""
    little = draw(st.booleans())
    length = draw(st.integers(1, 64))
    first = draw(st.integers(0, 8 * WIDTH - length))  # bits before it, counted as they are sent
    start = first if little else 8 * (first // 8) + 7 - first % 8
    return start, length, little


rows = st.lists(st.binary(min_size=WIDTH, max_size=WIDTH), min_size=1, max_size=5)


@given(rows, places(), st.booleans())
def test_integers_are_those_of_cantools(rows, place, signed):
    start, length, little = place
    data = np.frombuffer(b"".join(rows), np.uint8).reshape(len(rows), WIDTH)
    found = number(raw(data, start, length, little), length, signed, real=False)
    assert list(found) == [float(x) for x in theirs(rows, start, length, little, signed, False)]


@given(rows, st.sampled_from([16, 32, 64]), st.booleans())
def test_floats_are_those_of_cantools(rows, length, little):
    start = 8 if little else 15
    data = np.frombuffer(b"".join(rows), np.uint8).reshape(len(rows), WIDTH)
    with np.errstate(invalid="ignore"):  # a signalling NaN
        found = number(raw(data, start, length, little), length, True, real=True)
    np.testing.assert_array_equal(found, theirs(rows, start, length, little, True, True))


@given(places())
def test_the_last_byte_is_the_last_one_that_matters(place):
    """A frame cut before it cannot be decoded, one cut behind it can."""
    start, length, little = place
    last = last_byte(start, length, little)
    raw(np.zeros((1, last + 1), np.uint8), start, length, little)
    with pytest.raises(ValueError, match="mismatch"):
        raw(np.zeros((1, last), np.uint8), start, length, little)
