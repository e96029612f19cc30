"""What swings with a frequency of its own, told from errors that come with every application."""

import numpy as np
import pytest

from calib.diagnosis.explanation.channels import CHANNELS, STEP
from calib.diagnosis.proof.unexplained import Oscillation, oscillation_of

TIME = np.arange(0.0, 120.0, STEP)


def found(signal: np.ndarray, seed: int) -> Oscillation:
    """A signal in a_x beside noise of variance one in every channel."""
    noise = np.random.default_rng(seed).standard_normal((len(CHANNELS), TIME.size))
    noise[CHANNELS.index("a_x")] += signal
    return oscillation_of([dict(zip(CHANNELS, noise, strict=True))], float(signal @ signal))


@pytest.mark.parametrize("frequency", [0.55, 0.6, 0.8, 1.1, 2.3])
def test_a_swing_is_found_with_its_frequency(frequency):
    """A swing that an application starts every 10 s, with a hundredth of critical damping."""
    since = TIME % 10.0
    swing = 5.0 * np.exp(-0.06 * frequency * since) * np.sin(2.0 * np.pi * frequency * since)
    result = found(swing, 1)
    assert result.frequency == pytest.approx(frequency, abs=0.06)
    assert result.share > 0.7
    assert result.body


@pytest.mark.parametrize("time_constant", [0.1, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("apart", [3.0, 4.3, 6.1, 9.7])
def test_an_error_that_every_application_leaves_is_no_swing(time_constant, apart):
    """The answer to a lag: a step at the bite that dies away, and its opposite at the release."""
    since = TIME % apart
    half = 0.5 * apart
    error = np.exp(-since / time_constant) - np.where(
        since > half, np.exp(-(since - half) / time_constant), 0.0
    )
    assert found(10.0 * error, 2).share == 0.0
