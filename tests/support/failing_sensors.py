"""Samples of an ECU whose sensors fail, each in its way; in place."""

from collections.abc import Callable

import numpy as np

from calib.base.arrays import Array
from calib.ecu.channels import CHANNELS

LOW, HIGH = np.array([(channel.low, channel.high) for channel in CHANNELS.values()]).T
NO_NUMBERS = np.array([np.nan, np.inf, -np.inf, 1e30, -1e30, 1e-40, 0.0])
Way = Callable[[Array, np.random.Generator], None]


def no_numbers(x: Array, rng: np.random.Generator) -> None:
    """One channel for a while, twenty times: no number, infinite, out of range, nothing."""
    for at, c in zip(*rng.integers(x.shape, size=(20, 2)).T, strict=True):
        x[at : at + rng.integers(1, 60), c] = rng.choice(NO_NUMBERS)


def sprinkled(x: Array, rng: np.random.Generator) -> None:
    """Each value at times."""
    hit = rng.random(x.shape) < 0.02
    x[hit] = rng.choice(NO_NUMBERS, int(hit.sum()))


def anything(x: Array, rng: np.random.Generator) -> None:
    """Any number of the range."""
    hit = rng.random(x.shape) < rng.choice([0.02, 0.3, 1.0])
    x[hit] = (LOW + (HIGH - LOW) * rng.random(x.shape))[hit]


def stuck(x: Array, rng: np.random.Generator) -> None:
    """A channel at an end of its range, at nothing, or with the wrong sign, six times."""
    for at, c in zip(*rng.integers(x.shape, size=(6, 2)).T, strict=True):
        value = rng.choice([LOW[c], HIGH[c], 0.0, -x[at, c], 1e-30])
        x[at : at + rng.integers(1, 1500), c] = value


def ends(x: Array, rng: np.random.Generator) -> None:
    """Some channels jump from one end of their range to the other, every 50 samples."""
    high = np.repeat(rng.random((len(x) // 50 + 1, len(CHANNELS))) < 0.5, 50, axis=0)[: len(x)]
    hit = rng.random(len(CHANNELS)) < 0.6
    x[:, hit] = np.where(high, HIGH, LOW)[:, hit]


def gains(x: Array, rng: np.random.Generator) -> None:
    """Wrong gains and zeros, which are plausible and so go into the filter."""
    x *= np.exp(rng.normal(0.0, [1.0, 1.0, 0.3, 0.3, 0.3, 0.3, 0.0, 0.0, 0.0, 0.0]))
    x += rng.normal(0.0, [1e5, 1.0, 1.0, 1.0, 1.0, 1.0, 0.1, 0.0, 1e3, 1e3])


def jumps(x: Array, rng: np.random.Generator) -> None:
    """Gains that jump, of pressure, of a_x, and of both wheels of an axle."""
    steps = np.exp(rng.normal(0.0, [1.0, 1.0, 0.5, 0.5], (len(x) // 200 + 1, 4)))
    x[:, :6] *= np.repeat(steps, 200, axis=0)[: len(x), [0, 1, 2, 2, 3, 3]]


WAYS: tuple[Way, ...] = (no_numbers, sprinkled, anything, stuck, ends, gains, jumps)


def failing(samples: Array, seed: int) -> Array:
    """Samples (n, 10) whose sensors fail in the ``seed``-th way, modulo their number."""
    x = samples.copy()
    WAYS[seed % len(WAYS)](x, np.random.default_rng(seed))
    return x
