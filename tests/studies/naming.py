"""How often the hidden effect is named, on cases of the plant in tests/support/hidden.

    python tests/studies/naming.py --count 42 --seed 1
    python tests/studies/naming.py --count 9 --seed 5 --kind outside --rows rows.jsonl
    python tests/studies/naming.py --count 21 --kind single --severity 0
    python tests/studies/naming.py --count 12 --seed 9 --radii 0.2
    python tests/studies/naming.py --count 12 --seed 9 --unlike-tyres

``--count`` cases of each kind; successive seeds go round the names. ``--radii`` is the sd of the
vehicle file's rolling radii [%]; ``--unlike-tyres`` gives each axle one of Burckhardt's, Dugoff's
or a brush; ``--rows`` appends every case to a file, one JSON a line.
Limits are Wilson's, 95 %. A case fails on its own: an
error of the program is an outcome like any other and is counted.
"""

import json
import sys
import time
import traceback
from collections import Counter
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.diagnosis import Diagnosis
from tests.studies.score import FAINT, MOST_LEFT, Replays, Score, score
from tests.studies.study import arguments, carried_out, share
from tests.support.hidden.cases import KINDS, HiddenCase, draw


@dataclass(frozen=True)
class Row:
    """One case: its seed, car and settings, its score, how long the diagnosis took [s]."""

    seed: int
    answer: dict[str, Any]
    score: Score | None
    seconds: float
    error: str = ""


@dataclass(frozen=True)
class Job:
    """What one worker is asked."""

    kind: str
    seed: int
    severity: int | None
    radii: float
    unlike_tyres: bool


def main() -> None:
    """Draw, diagnose, score, print."""
    asked = arguments(
        __doc__, "unlike_tyres",
        count=21, seed=0, severity=-1, radii=0.0, jobs=1, rows="", kind=list(KINDS),
    )  # fmt: skip
    severity = None if asked.severity < 0 else asked.severity
    jobs = [
        Job(kind, asked.seed + i, severity, asked.radii, asked.unlike_tyres)
        for kind in asked.kind
        for i in range(asked.count)
    ]
    rows = []
    for row in carried_out(carry_out, jobs, asked.jobs):
        print(line(row), file=sys.stderr, flush=True)
        rows.append(row)
        if asked.rows:
            with Path(asked.rows).open("a") as file:
                file.write(json.dumps(asdict(row)) + "\n")
    print(report(rows))


def carry_out(job: Job) -> Row:
    """Draw one case and diagnose it."""
    case = draw(job.kind, job.seed, severity=job.severity, unlike_tyres=job.unlike_tyres)
    off = 0.01 * job.radii * float(np.random.default_rng(job.seed).normal())
    case = replace(case, vehicle=case.vehicle.with_radii(1.0 + off))
    start = time.perf_counter()
    try:
        answer, before, after = diagnosed(case)
    except Exception:
        spent = time.perf_counter() - start
        return Row(job.seed, case.answer, None, spent, traceback.format_exc(limit=-2))
    spent = time.perf_counter() - start
    return Row(job.seed, case.answer, score(case, answer, before, after), spent)


def diagnosed(case: HiddenCase) -> tuple[dict[str, Any], Replays, Replays]:
    """Run the program on what it may see."""
    found = diagnose(case.vehicle, list(case.calibration), list(case.holdout))
    replays = found.replays_before, found.replays_after
    before, after = ({log.name: log.channels for log in logs} for logs in replays)
    return told(found), before, after


def told(diagnosis: Diagnosis) -> dict[str, Any]:
    """What diagnosis.json says, as far as the score reads it."""
    effects = [
        {
            "name": effect.name,
            "parameters": {k: asdict(v) for k, v in effect.parameters.items()},
            "indistinguishable_from": list(effect.indistinguishable_from),
        }
        for effect in diagnosis.effects
    ]
    left = diagnosis.unexplained
    unexplained = {} if left is None else {"axle": left.axle, "driver": left.driver}
    return {"verdict": diagnosis.verdict, "effects": effects, "unexplained": unexplained}


def line(row: Row) -> str:
    """One case in one line."""
    truth = "+".join(row.answer["effects"]) or "nothing"
    if row.score is None:
        return f"{row.seed:6} {truth}: {row.error.strip().splitlines()[-1]}"
    s = row.score
    name = "+".join(s.named) or "-"
    return (
        f"{row.seed:6} {truth}: {s.verdict} {name} -> {s.outcome}, closed {100 * s.closed:.1f} %, "
        f"{row.seconds:.1f} s"
    )


def report(rows: list[Row]) -> str:
    """The goals with their limits, what was taken for what, intervals by parameter."""
    failed = [row for row in rows if row.score is None]
    scores = [row.score for row in rows if row.score is not None]
    parts = [f"{len(rows)} cases drawn, {len(failed)} without a diagnosis"]
    if scores:
        parts += [goals(scores, rows), confusions(scores), coverage(scores)]
    parts += [line(row) for row in failed[:10]]
    return "\n\n".join(parts)


OUTCOMES = (
    # what, kinds, the goal [%], outcomes that count
    ("one effect: exact name", "single", ">= 95", "exact"),
    ("one effect: exact or in the set", "single", "", "exact set"),
    ("one effect: wrong name", "single", "<= 2", "wrong"),
    ("two effects: both exact", "double", ">= 90", "exact"),
    ("two effects: wrong name", "double", "<= 2", "wrong"),
    ("three effects: all exact", "triple", ">= 70", "exact"),
    ("three effects: wrong name", "triple", "<= 2", "wrong"),
    ("nothing hidden: no gap", "none", ">= 99", "exact"),
    ("nothing hidden, other logs: no gap", "varied", ">= 99", "exact"),
    ("own pads and tyres, one effect: exact", "unlike", "", "exact"),
    ("own pads and tyres: wrong name", "unlike", "", "wrong"),
    ("outside: a single wrong name", "outside", "<= 2", "wrong"),
)


def goals(scores: list[Score], rows: list[Row]) -> str:
    """The table of goals."""

    def of(kind: str) -> list[Score]:
        found = [s for s in scores if s.kind == kind]
        return [s for s in found if kind != "single" or not set(s.truth) & FAINT]

    faint = [s for s in scores if s.kind == "single" and set(s.truth) & FAINT]
    outside, intervals = of("outside"), [i for s in scores for i in s.intervals]
    table = [
        (name, goal, [s.outcome in outcomes.split() for s in of(kind)])
        for name, kind, goal, outcomes in OUTCOMES
    ]
    table += [
        ("outside: unknown or a set", ">= 95", [s.passed for s in outside]),
        ("outside: axle right, where said", "", [s.axle for s in outside if s.axle is not None]),
        ("outside: driver right", "", [s.driver for s in outside if s.driver is not None]),
        (f"more than {MOST_LEFT:g} noise units left, not told", "<= 1", [s.silent for s in scores]),
        ("mass, inertia: set or no gap", ">= 95", [s.passed for s in faint]),
        ("intervals hold the truth", "93-97", [i.held for i in intervals]),
    ]  # fmt: skip
    out = ["| | goal % | % (95 % limits, n) |", "|---|---|---|"]
    out += [f"| {name} | {goal} | {share(hits)} |" for name, goal, hits in table if hits]
    for kind in ("single", "double"):
        if values := [s.closed for s in of(kind)]:
            low, middle, high = np.percentile(values, [25, 50, 75])
            out.append(f"| {kind}: gap closed, median (quartiles) | >= 95 | {100 * middle:.1f} "
                       f"({100 * low:.1f}-{100 * high:.1f}, n {len(values)}) |")  # fmt: skip
    seconds = [row.seconds for row in rows if row.score is not None]
    out.append(f"| seconds a case, median (worst) | <= 10 | {np.median(seconds):.1f} "
               f"({max(seconds):.1f}, n {len(seconds)}) |")  # fmt: skip
    return "\n".join(out)


def confusions(scores: list[Score]) -> str:
    """What was taken for what."""
    count = Counter(
        ("+".join(s.truth) or "nothing", f"{s.outcome}: {'+'.join(s.named) or s.verdict}")
        for s in scores
        if s.outcome != "exact"
    )
    lines = [f"{n:4} x {truth} -> {said}" for (truth, said), n in sorted(count.items())]
    return "\n".join(["not exact:", *(lines or ["   none"])])


def coverage(scores: list[Score]) -> str:
    """Intervals by parameter."""
    held: dict[str, list[bool]] = {}
    for i in (i for s in scores for i in s.intervals):
        held.setdefault(f"{i.effect}.{i.parameter}", []).append(i.held)
    lines = [f"{name}: {sum(hits)} of {len(hits)}" for name, hits in sorted(held.items())]
    return "\n".join(["intervals that hold the truth:", *lines])


if __name__ == "__main__":
    main()
