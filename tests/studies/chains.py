"""Diagnoses of logs that come over a bus: what is found, and what the measuring chain adds.

    python tests/studies/chains.py --count 10 --seed 1
    python tests/studies/chains.py --count 10 --seed 1 --kind none --clean

Cases of the plant in tests/support/hidden, each with a chain of its own: messages of 50 or 100 Hz
for a_x, the wheels and p_mc, 10 to 50 Hz for v, up to 30 ms late, a_x behind a Butterworth filter
of 8 to 25 Hz, steps of 0.02 m/s^2, 0.03 rad/s, 0.2 bar and 0.01 m/s (rates and steps of the bus of
a brake control unit and of a receiver of satellites; our estimate). With ``--clean`` the same cases
without it. An answer is right if it has the names of what was hidden, delays of channels apart: the
chain has some. It is a part if it has some of them, wrong if it has others, imitated if these are
what several delays look like.
"""

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.search.clocks import DELAYS
from tests.studies.naming import wilson
from tests.studies.pool import carried_out
from tests.support.hidden.cases import draw
from tests.support.measuring_chain import Message, chained

KINDS = ("none", "single", "double")
LIKE_DELAYS = {"hydraulic_lag", "hydraulic_oscillation"}
"""Effects that late and filtered channels together imitate."""


@dataclass(frozen=True)
class Job:
    """One case, over a bus or ``clean``."""

    kind: str
    seed: int
    clean: bool


@dataclass(frozen=True)
class Row:
    """What was hidden and named, the outcome, how much is left, seconds."""

    job: Job
    hidden: tuple[str, ...]
    named: tuple[str, ...]
    verdict: str
    outcome: str
    innovation: float
    left: float
    seconds: float


def chain(rng: np.random.Generator) -> dict[str, Message]:
    """A chain as a car may have it."""

    def late() -> float:
        return float(rng.uniform(0.0, 0.03))

    return {
        "p_mc": Message(float(rng.choice([50, 100])), late(), 0.2e5),
        "a_x": Message(float(rng.choice([50, 100])), late(), 0.02, float(rng.uniform(8, 25))),
        "omega": Message(float(rng.choice([50, 100])), late(), 0.03),
        "v": Message(float(rng.choice([10, 20, 50])), late(), 0.01),
    }


def carry_out(job: Job) -> Row:
    """Draw, record, diagnose."""
    case = draw(job.kind, job.seed)
    logs = [*case.calibration, *case.holdout]
    if not job.clean:
        rng = np.random.default_rng(job.seed)
        messages = chain(rng)
        logs = [chained(log, messages, rng) for log in logs]
    start = time.perf_counter()
    split = len(case.calibration)
    found = diagnose(case.vehicle, logs[:split], logs[split:])
    named = tuple(effect.name for effect in found.effects)
    hidden = tuple(case.answer["effects"])
    return Row(
        job,
        hidden,
        named,
        found.verdict,
        outcome(set(hidden), set(named), found.verdict),
        found.reduced_after,
        found.left.size,
        time.perf_counter() - start,
    )


def outcome(hidden: set[str], named: set[str], verdict: str) -> str:
    """Right, a part, imitated, wrong, or unknown."""
    if verdict == "unknown":
        return "unknown"
    of_car = hidden - set(DELAYS)
    others = named - hidden - set(DELAYS)
    if others:
        return "imitated" if others <= LIKE_DELAYS and of_car <= named else "wrong"
    return "right" if of_car <= named else "part"


def main() -> None:
    """Print each case, then the shares by kind."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", action="append", choices=KINDS)
    parser.add_argument("--clean", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    asked = parser.parse_args()
    kinds = asked.kind or KINDS
    jobs = [Job(k, asked.seed + i, asked.clean) for k in kinds for i in range(asked.count)]
    rows = []
    for row in carried_out(carry_out, jobs, asked.jobs):
        rows.append(row)
        print(
            f"{row.job.seed} {'+'.join(row.hidden) or 'nothing'}: {row.verdict} "
            f"{'+'.join(row.named) or '-'} -> {row.outcome}, innovation {row.innovation:.3f}, "
            f"left {row.left:.1f}, {row.seconds:.0f} s",
            flush=True,
        )
    for kind in kinds:
        of_kind = [row for row in rows if row.job.kind == kind]
        counts = Counter(row.outcome for row in of_kind)
        low, high = wilson(counts["right"], len(of_kind))
        others = ", ".join(f"{n} {word}" for word, n in counts.items() if word != "right")
        print(
            f"{kind}: right {counts['right']} of {len(of_kind)} "
            f"({100 * low:.0f} to {100 * high:.0f} %){', ' + others if others else ''}"
        )


if __name__ == "__main__":
    main()
