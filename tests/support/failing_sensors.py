"""Samples of an ECU whose sensors fail, each in its way."""

from collections.abc import Callable

import numpy as np

from calib.base.arrays import Array
from calib.ecu.online import RANGES

LOW, HIGH = np.array(list(RANGES.values())).T
NO_NUMBERS = np.array([np.nan, np.inf, -np.inf, 1e30, -1e30, 1e-40, 0.0])


def no_numbers(x: Array, rng: np.random.Generator) -> Array:
    """One channel for a while, twenty times: no number, infinite, out of range, nothing."""
    for _ in range(20):
        at, channel = rng.integers(len(x)), rng.integers(len(RANGES))
        x[at : at + rng.integers(1, 60), channel] = rng.choice(NO_NUMBERS)
    return x


def sprinkled(x: Array, rng: np.random.Generator) -> Array:
    """Each value at times."""
    hit = rng.random(x.shape) < 0.02
    x[hit] = rng.choice(NO_NUMBERS, int(hit.sum()))
    return x


def anything(x: Array, rng: np.random.Generator) -> Array:
    """Any number of the range."""
    hit = rng.random(x.shape) < rng.choice([0.02, 0.3, 1.0])
    return np.where(hit, LOW + (HIGH - LOW) * rng.random(x.shape), x)


def stuck(x: Array, rng: np.random.Generator) -> Array:
    """A channel at an end of its range, at nothing, or with the wrong sign, six times."""
    for at, c in zip(rng.integers(len(x), size=6), rng.integers(len(RANGES), size=6), strict=True):
        value = rng.choice([LOW[c], HIGH[c], 0.0, -x[at, c], 1e-30])
        x[at : at + rng.integers(1, 1500), c] = value
    return x


def ends(x: Array, rng: np.random.Generator) -> Array:
    """Some channels jump from one end of their range to the other, every 50 samples."""
    high = np.repeat(rng.random((len(x) // 50 + 1, len(RANGES))) < 0.5, 50, axis=0)[: len(x)]
    return np.where(rng.random(len(RANGES)) < 0.6, np.where(high, HIGH, LOW), x)


def gains(x: Array, rng: np.random.Generator) -> Array:
    """Wrong gains and zeros, which are plausible and so go into the filter."""
    gain = np.exp(rng.normal(0.0, [1.0, 1.0, 0.3, 0.3, 0.3, 0.3, 0.0, 0.0, 0.0, 0.0]))
    return x * gain + rng.normal(0.0, [1e5, 1.0, 1.0, 1.0, 1.0, 1.0, 0.1, 0.0, 1e3, 1e3])


def jumps(x: Array, rng: np.random.Generator) -> Array:
    """Gains that jump, of pressure, of a_x, and of both wheels of an axle."""
    steps = np.exp(rng.normal(0.0, [1.0, 1.0, 0.5, 0.5], (len(x) // 200 + 1, 4)))
    return x * np.repeat(steps, 200, axis=0)[: len(x), [0, 1, 2, 2, 3, 3, 0, 0, 0, 0]]


WAYS: tuple[Callable[[Array, np.random.Generator], Array], ...] = (
    no_numbers, sprinkled, anything, stuck, ends, gains, jumps,
)  # fmt: skip


def failing(samples: Array, seed: int) -> Array:
    """Samples (n, 10) whose sensors fail in the ``seed``-th way, modulo their number."""
    return WAYS[seed % len(WAYS)](samples.copy(), np.random.default_rng(seed))
