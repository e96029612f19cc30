"""What errors that last are worth as noise, against drawn ones."""

from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.filter_input import lasting_error
from calib.estimation.priors import Priors


@pytest.mark.parametrize(("length", "memory"), [(0.05, 0.1), (0.01, 0.1), (0.05, 0.5)])
def test_the_mean_of_white_noise_is_as_uncertain_as_that_of_an_error_that_lasts(length, memory):
    """Processes of the first order over 1000 times their memory, and the spread of their means."""
    rng = np.random.default_rng(2)
    blocks, keeps = int(1000.0 * memory / length), np.exp(-length / memory)
    x, total = rng.standard_normal(400), np.zeros(400)
    for _ in range(blocks):
        x = keeps * x + np.sqrt(1.0 - keeps**2) * rng.standard_normal(400)
        total += x
    white = lasting_error(length, replace(Priors(), model_memory=memory)) / np.sqrt(blocks)
    assert np.std(total / blocks) == pytest.approx(white, rel=0.1)
