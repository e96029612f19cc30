"""A jolt of a_x is told from brakes that change; the level of the pads rests on the latter."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.estimation.estimator import estimate
from tests.support.reference_car import REAL, noisy, stop


@pytest.fixture(scope="module")
def log():
    return noisy(stop(REAL), 5)


def with_force(log, factor):
    """The log with a_x that is ``factor`` (n,) times as large."""
    return replace(log, channels={**log.channels, "a_x": log["a_x"] * factor})


@pytest.mark.parametrize(("size", "late"), [(-0.6, 4.5), (1.0, 3.0)])
def test_a_jolt_leaves_the_level_alone(fitted, log, size, late):
    """The body goes to and fro in 0.24 s, as on a bump; its speed is the same afterwards."""
    swing = np.where((log.time > late) & (log.time < late + 0.24), size, 0.0)
    pulse = 1.0 + swing * np.where(log.time < late + 0.12, 1.0, -1.0)
    plain, hit = (estimate(fitted, run) for run in (log, with_force(log, pulse)))
    after = (log.time > late + 0.2) & (log.time < late + 1.5)
    assert np.max(np.abs(hit.level.value / plain.level.value - 1.0)[after]) < 0.03


@pytest.mark.parametrize("factor", [0.8, 1.25])
def test_brakes_that_stay_changed_are_followed(fitted, log, factor):
    steps = np.where(log.time > 3.0, factor, 1.0)
    plain, changed = (estimate(fitted, run) for run in (log, with_force(log, steps)))
    at = int(np.searchsorted(log.time, 4.5))
    assert log["a_x"][at] < -0.1 * G
    assert changed.level.value[at] / plain.level.value[at] == pytest.approx(factor, abs=0.05)
