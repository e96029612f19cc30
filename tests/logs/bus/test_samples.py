"""Files of other projects (samples/SOURCES.txt): signals are what canmatrix decodes."""

import logging
import warnings

import numpy as np
import pytest

from calib.logs.bus.dbc import read_databases
from calib.logs.bus.recording import decode, frames_of
from tests.support.databases import SAMPLES

FRAMES = 30


def theirs(path):
    """Frames of canmatrix by identifier."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import canmatrix.formats

        logging.getLogger("canmatrix").setLevel(logging.CRITICAL)
        found = canmatrix.formats.loadp(str(path))
    return {
        (frame.arbitration_id.id, bool(frame.arbitration_id.extended)): frame
        for matrix in found.values()
        for frame in matrix.frames
    }


def random_frames(key, length):
    rows = np.random.default_rng(key[0]).integers(0, 256, (FRAMES, length), np.uint8)
    data = [bytes(row) for row in rows]
    return data, frames_of("0", key, np.arange(float(FRAMES)), data)


def ours(frames, message, signal):
    """Value by number of the frame."""
    found = decode(frames, message, signal)
    return dict(zip(found.time.astype(int).tolist(), found.values.tolist(), strict=True))


@pytest.mark.parametrize("path", sorted(SAMPLES.glob("*.*[dkx][bcm][cdl]")), ids=lambda p: p.name)
def test_signals_are_those_of_another_reader(path):
    matrix, compared = theirs(path), 0
    for key, message in read_databases({"": [path]}, "can", "x").buses[""].items():
        data, frames = random_frames(key, message.length)
        decoded = [matrix[key].decode(row) for row in data]
        for signal in message.signals:
            expected = {i: float(row[signal.name].phys_value) for i, row in enumerate(decoded)
                        if signal.name in row}  # fmt: skip
            found = ours(frames, message, signal)
            assert found.keys() == expected.keys(), signal.name
            np.testing.assert_allclose(
                [found[i] for i in expected], list(expected.values()), rtol=1e-12, equal_nan=True
            )
            compared += len(expected)
    assert compared >= 20
