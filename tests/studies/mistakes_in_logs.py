"""Mistakes of what the logs say: gains, zeros, delays, clocks, channels in the wrong place."""

from dataclasses import replace

import numpy as np

from calib.logs.log import Log
from tests.studies.made_lines import BAR, RUNS
from tests.studies.mistake import Logs, Make, Mistake, Rng, in_channel, off_by, percent

G = 9.80665


def gain(runs: tuple[str, ...], channel: str, low: float, high: float) -> Make:
    def make(rng: Rng) -> Mistake:
        k = off_by(rng, low, high)
        return Mistake(percent(k), logs=in_channel(runs, channel, lambda x, log: k * x))

    return make


def times(runs: tuple[str, ...], channel: str, k: float) -> Make:
    return lambda rng: Mistake(f"x {k:g}", logs=in_channel(runs, channel, lambda x, log: k * x))


def acceleration_offset(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        b = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.5))
        return Mistake(f"{b:+.2f} m/s^2", logs=in_channel(runs, "a_x", lambda x, log: x + b))

    return make


def pressure_offset(floor: float) -> Make:
    def make(rng: Rng) -> Mistake:
        b = float(rng.choice([-1.0, 1.0]) * rng.uniform(1.5, 6.0))
        change = in_channel(RUNS, "p_mc", lambda x, log: np.maximum(x + b * BAR, floor))
        return Mistake(f"{b:+.1f} bar", logs=change)

    return make


def late(runs: tuple[str, ...], channel: str) -> Make:
    def make(rng: Rng) -> Mistake:
        delay = float(rng.uniform(0.1, 0.4))

        def shifted(x: np.ndarray, log: Log) -> np.ndarray:
            n = round(delay / log.sample_time)
            return np.concatenate([np.full(n, x[0]), x[:-n]])

        return Mistake(f"{delay:.2f} s", logs=in_channel(runs, channel, shifted))

    return make


def clock(channel: str) -> Make:
    """The clock of whole logs, or of one channel in them."""

    def make(rng: Rng) -> Mistake:
        k = off_by(rng, 0.02, 0.10)
        if channel == "time":
            return Mistake(percent(k), logs=in_channel(RUNS, "time", lambda t, log: k * t))
        change = in_channel(RUNS, channel, lambda x, log: np.interp(log.time / k, log.time, x))
        return Mistake(percent(k), logs=change)

    return make


def copied(channel: str, source: str) -> Make:
    change = in_channel(RUNS, channel, lambda x, log: log[source].copy())
    return lambda rng: Mistake(f"{source} in {channel}", logs=change)


def pressure_in_acceleration(rng: Rng) -> Mistake:
    k = float(rng.uniform(0.9, 1.1)) * G / 70e5
    change = in_channel(RUNS, "a_x", lambda x, log: -k * log["p_mc"])
    return Mistake("p_mc in a_x", logs=change)


def swapped(pairs: tuple[tuple[str, str], ...]) -> Make:
    def exchange(logs: Logs) -> Logs:
        new = {a: b for pair in pairs for a, b in (pair, pair[::-1])}
        return {
            name: replace(
                log,
                channels={
                    **log.channels,
                    **{f"omega_{a}": log[f"omega_{b}"] for a, b in new.items()},
                },
            )
            for name, log in logs.items()
        }

    return lambda rng: Mistake("+".join(f"{a}<->{b}" for a, b in pairs), logs=exchange)


def ramp_again(rng: Rng) -> Mistake:
    return Mistake("stop_1", logs=lambda logs: {**logs, "stop_1": logs["ramp"]})
