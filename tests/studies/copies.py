"""Copies of a run, and runs that only look alike: how often is each told from the other?

    python tests/studies/copies.py [--cars 8] [--seed 81]

Each car drives a ramp and a stop, and both again with the same pedal: to the last digit, with pads
that are 0.5 % apart, and 0.1 m/s faster. Every run is measured with noise of its own, usual, quiet
or loud, whole or only 3 s of it. Copies are made of each. Both questions are asked: log against
log, and log against the fingerprint that a table keeps.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.logs.log import Log
from calib.model.sensor_noise import LEVELS, add_noise
from calib.run.same_run import fingerprint_of, noise_of, same_as, same_run
from tests.studies.made_lines import Run, line
from tests.support.plant import as_log, drive

RATE = 200.0
LOUDNESS = {"usual": 1.0, "a tenth": 0.1, "three times": 3.0}
LENGTHS = {"whole": None, "3 s": (1.0, 4.0)}
KINDS = ("to the last digit", "pads 0.5 % apart", "0.1 m/s faster", "another pedal")


def at(log: Log, time: np.ndarray, shift: float = 0.0) -> Log:
    """The log interpolated to other times [s]; its clock is ``shift`` [s] late."""
    channels = {name: np.interp(time, log.time, x) for name, x in log.channels.items()}
    return replace(log, channels=channels | {"time": time + shift}, digest="")


def rows(log: Log, part: slice) -> Log:
    """Some rows of a log."""
    return replace(log, channels={k: x[part] for k, x in log.channels.items()}, digest="")


def rounded(log: Log, times: float) -> Log:
    """Every channel in steps of so many times its noise."""
    steps = {name: times * noise_of(log[name]) for name in log.channels if name != "time"}
    channels = {name: np.round(log[name] / s) * s for name, s in steps.items()}
    return replace(log, channels=channels | {"time": log.time}, digest="")


def means(log: Log, n: int) -> Log:
    """Means of ``n`` rows."""
    count = log.time.size // n * n
    channels = {k: x[:count].reshape(-1, n).mean(axis=1) for k, x in log.channels.items()}
    return replace(log, channels=channels, digest="")


COPIES: dict[str, Callable[[Log], Log]] = {
    "saved again": lambda log: rows(log, slice(None)),
    "first row missing": lambda log: rows(log, slice(1, None)),
    "cut at both ends": lambda log: rows(log, slice(37, -61)),
    "half": lambda log: rows(log, slice(0, log.time.size // 2)),
    "clock + 10 s": lambda log: at(log, log.time, 10.0),
    "every 2nd row": lambda log: rows(log, slice(None, None, 2)),
    "every 3rd row": lambda log: rows(log, slice(1, None, 3)),
    "every 5th row": lambda log: rows(log, slice(3, None, 5)),
    "means of 2": lambda log: means(log, 2),
    "means of 5": lambda log: means(log, 5),
    "at 70 Hz": lambda log: at(log, np.arange(log.time[0] + 0.0032, log.time[-1], 1.0 / 70.0)),
    "at 1 kHz": lambda log: at(log, np.arange(log.time[0], log.time[-1], 1e-3)),
    "rounded to its noise": lambda log: rounded(log, 1.0),
    "rounded to 3 times its noise": lambda log: rounded(log, 3.0),
}


def runs_of(rng: np.random.Generator, seed: int) -> dict[str, dict[str, Log]]:
    """Clean logs of a car, by drive and kind."""
    made = line(rng, seed)
    return {
        name: {
            KINDS[0]: _clean(made.runs[name]),
            KINDS[1]: _clean(_other_pads(made.runs[name])),
            KINDS[2]: _clean(replace(made.runs[name], speed=made.runs[name].speed + 0.1)),
            KINDS[3]: _clean(made.runs[other]),
        }
        for name, other in (("ramp", "stop_3"), ("stop_1", "stop_2"))
    }


def _other_pads(run: Run) -> Run:
    front, rear = run.plant.pads(0.0)
    return replace(run, plant=replace(run.plant, pads=lambda t: (1.005 * front, 1.005 * rear)))


def _clean(run: Run) -> Log:
    how = {"duration": run.duration, "stop_speed": run.stop_speed, "rate": RATE, "rtol": 1e-6}
    log = as_log(drive(run.plant, run.pressure, run.speed, **how))
    hidden = ("p_f", "p_r", "T_")
    return replace(
        log, channels={k: x for k, x in log.channels.items() if not k.startswith(hidden)}, digest=""
    )


def measured(clean: Log, seed: int, loud: float, span: tuple[float, float] | None) -> Log:
    """A log with noise and steps of its own, or ``span`` [s] of it."""
    levels = {k: replace(x, sd=loud * x.sd, quantum=loud * x.quantum) for k, x in LEVELS.items()}
    log = replace(add_noise(clean, seed, levels), digest="")
    if span is None:
        return log
    inside = (log.time >= span[0]) & (log.time < span[1])
    return replace(log, channels={k: x[inside] for k, x in log.channels.items()})


def study(cars: int, seed: int) -> Iterator[tuple[str, str, bool, bool]]:
    """(what, kind or copy, told by the log, told by the fingerprint) of each question."""
    rng, noise = np.random.default_rng(seed), 1000 * seed
    for car in range(cars):
        for logs in runs_of(rng, seed + car).values():
            for name, loud in LOUDNESS.items():
                for length, span in LENGTHS.items():
                    noise += 20
                    own = measured(logs[KINDS[0]], noise, loud, span)
                    kept = fingerprint_of(own)
                    case = f"{name} noise, {length}"
                    for n in range(4):
                        for i, kind in enumerate(KINDS):
                            other = measured(logs[kind], noise + 4 * n + i + 1, loud, span)
                            yield case, kind, same_run(own, other), same_as(kept, other)
                    for done, copy in COPIES.items():
                        made = copy(own)
                        yield case, done, same_run(own, made), same_as(kept, made)


def main() -> None:
    """Print how many were called one run, by case: of the logs and of the fingerprint."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cars", type=int, default=8)
    parser.add_argument("--seed", type=int, default=81)
    args = parser.parse_args()
    asked, by_log, by_print = Counter(), Counter(), Counter()
    for case, kind, told, kept in study(args.cars, args.seed):
        for key in ((case, kind), ("all", kind)):
            asked[key] += 1
            by_log[key] += told
            by_print[key] += kept
    for key, n in asked.items():
        print(f"{key[0]:>28}  {key[1]:<30} log {by_log[key]:>4}, print {by_print[key]:>4} of {n}")


if __name__ == "__main__":
    main()
