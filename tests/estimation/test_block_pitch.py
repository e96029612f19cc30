"""Deficit of the pitch mode by blocks: the mean of the fine one, and its slope by the frequency."""

import numpy as np
import pytest

from calib.car.effects.body import pitch_deficit
from calib.estimation.block_pitch import block_pitch
from calib.estimation.priors import Priors
from calib.run.axle_signals import signals
from calib.run.blocks import blocks
from calib.run.filters import block_mean
from tests.support.reference_car import CAR, WET, stop


@pytest.fixture(scope="module")
def read():
    return signals(stop(WET, 45e5), CAR)


def test_it_is_the_mean_of_the_fine_one(read):
    b, p = blocks(read), Priors()
    fine = pitch_deficit(CAR, read.time, read.z, p.pitch_frequency, p.pitch_damping)
    found = block_pitch(CAR, b, p).deficit
    assert np.max(np.abs(found - block_mean(fine, b.samples))) < 0.03 * np.max(np.abs(fine))
