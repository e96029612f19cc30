"""Mistakes in the logs of a diagnosis: how many are refused, and how often good logs are.

    python tests/studies/mixed_up.py --count 10 --seed 1

``--count`` cases of each kind, of the plant in tests/support/hidden. The logs of each are given as
they are; then with one mistake after the other. A mistake is refused, warned of where nothing
explains it, or silent. Nothing is searched, so no verdict is needed. Also printed: the least share
of the deceleration that a pressure of its own run explains, and the largest brakes of a log over
those of the others, whatever is hidden.
"""

import argparse
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import LogError
from calib.diagnosis.diagnose import checked
from calib.diagnosis.runs.judged import judged_logs
from calib.logs.log import Log
from calib.run.observation import observe
from tests.support.hidden.cases import HiddenCase, draw
from tests.support.reference_car import swapped

KINDS = ("none", "single", "triple", "varied", "groups")
Logs = tuple[list[Log], list[Log]]


def changed(log: Log, **channels: np.ndarray) -> Log:
    """The log with other channels."""
    return replace(log, channels=log.channels | channels, digest="")


def rows(log: Log, at: slice) -> Log:
    """Some rows of the log."""
    return replace(log, channels={n: x[at] for n, x in log.channels.items()}, digest="")


def rounded(log: Log) -> Log:
    """The log with values of other steps."""
    steps = {"p_mc": 3e4, "a_x": 0.03, "v": 0.02}
    rounds = {
        n: np.round(x / steps.get(n, 0.02)) * steps.get(n, 0.02) for n, x in log.channels.items()
    }
    return changed(log, **{n: x for n, x in rounds.items() if n != "time"})


def resampled(log: Log) -> Log:
    """The log on another clock, from another time on."""
    rate = 0.7 / log.sample_time
    time = np.arange(log.time[0] + 0.7, log.time[-1], 1.0 / rate)
    channels = {n: np.interp(time, log.time, x) for n, x in log.channels.items()}
    return replace(log, channels=channels | {"time": time - time[0]}, digest="")


COPIES: dict[str, Callable[[Log], Log]] = {
    "saved again": lambda log: changed(log),
    "rounded": rounded,
    "cut by a second": lambda log: rows(log, slice(round(1.0 / log.sample_time), None)),
    "every second sample": lambda log: rows(log, slice(None, None, 2)),
    "resampled": resampled,
}


def mistakes(case: HiddenCase, rng: np.random.Generator) -> Iterator[tuple[str, Logs]]:
    """Every mistake with the calibration logs and the hold-outs that it leaves."""
    logs, held = list(case.calibration), list(case.holdout)
    braked = [i for i, log in enumerate(logs) if np.max(log["p_mc"]) > 8e5]
    i, j = (int(k) for k in rng.choice(braked, 2, replace=False))
    radius = case.vehicle.rear.rolling_radius

    def one(change: Callable[[Log], Log]) -> Logs:
        return [change(log) if k == i else log for k, log in enumerate(logs)], held

    def every(change: Callable[[Log], Log]) -> Logs:
        return [change(log) for log in logs], [change(log) for log in held]

    def of_another(log: Log) -> Log:
        return changed(log, p_mc=np.interp(log.time, logs[j].time, logs[j]["p_mc"]))

    for name, copy in COPIES.items():
        yield f"hold-out is a copy, {name}", (logs, [*held, copy(logs[i])])
    yield "wheel speeds swapped in all", every(swapped)
    yield "wheel speeds swapped in one", one(swapped)
    yield "a_x reversed in all", every(lambda log: changed(log, a_x=-log["a_x"]))
    yield "a_x reversed in one", one(lambda log: changed(log, a_x=-log["a_x"]))
    yield "p_mc is 0 in one", one(lambda log: changed(log, p_mc=0.0 * log["p_mc"]))
    yield "p_mc of another run in one", one(of_another)
    yield "v made of a wheel speed", every(lambda log: changed(log, v=radius * log["omega_rl"]))


def outcome(case: HiddenCase, logs: list[Log], held: list[Log]) -> str:
    """What is done with these logs."""
    try:
        return "warned" if checked(case.vehicle, logs, held) else "silent"
    except LogError as error:
        print(f"    {error}", file=sys.stderr)
        return "refused"


def main() -> None:
    """Draw, spoil, count."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=10, help="cases of each kind")
    parser.add_argument("--seed", type=int, default=0, help="of the first case")
    parser.add_argument("--spoil", default="none,single", help="kinds in which mistakes are made")
    asked = parser.parse_args()
    found: dict[str, Counter[str]] = defaultdict(Counter)
    least, levels = 1.0, [1.0]
    for kind in KINDS:
        for seed in range(asked.seed, asked.seed + asked.count):
            case = draw(kind, seed)
            logs, held = list(case.calibration), list(case.holdout)
            good = outcome(case, logs, held)
            found[f"good logs, {kind}"][good] += 1
            print(kind, seed, "+".join(case.effects), good, file=sys.stderr, flush=True)
            shares = [observe(log, noise=False).explained for log in (*logs, *held)]
            least = min([least, *(share for share in shares if share is not None)])
            judged = judged_logs(case.vehicle, [*logs, *held])
            levels += [level for one in judged if (level := one.over_others(judged)) is not None]
            if kind not in asked.spoil.split(","):
                continue
            for name, spoilt in mistakes(case, np.random.default_rng(seed)):
                found[name][outcome(case, *spoilt)] += 1
    for name, counts in found.items():
        print(f"{name:40} {', '.join(f'{n} {what}' for what, n in sorted(counts.items()))}")
    print(f"least share explained {least:.3f}; brakes {min(levels):.2f} to {max(levels):.2f}")


if __name__ == "__main__":
    main()
