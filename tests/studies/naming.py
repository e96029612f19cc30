"""How often the hidden effect is named, on cases of the plant in tests/hidden.

    python tests/studies/naming.py --count 42 --seed 1
    python tests/studies/naming.py --count 9 --seed 5 --kind outside --rows rows.jsonl
    python tests/studies/naming.py --count 21 --kind single --severity 0 --write /tmp/cases
    python tests/studies/naming.py --count 12 --seed 9 --radii 0.2

``--count`` cases of each kind; successive seeds go round the names. Limits are Wilson's, 95 %. A
case fails on its own: an error of the program is an outcome like any other and is counted.
"""

import argparse
import json
import math
import sys
import time
import traceback
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.studies.pool import carried_out
from tests.support.hidden.cases import KINDS, HiddenCase, draw, write
from tests.support.hidden.score import FAINT, MOST_LEFT, Replays, Score, score


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
    folder: Path | None
    radii: float


def main() -> None:
    """Draw, diagnose, score, print."""
    asked = arguments()
    jobs = [
        Job(kind, asked.seed + i, asked.severity, asked.write, asked.radii)
        for kind in asked.kind
        for i in range(asked.count)
    ]
    rows = []
    for row in carried_out(carry_out, jobs, asked.jobs):
        print(line(row), file=sys.stderr, flush=True)
        rows.append(row)
        if asked.rows:
            with asked.rows.open("a") as file:
                file.write(json.dumps(asdict(row)) + "\n")
    print(report(rows))


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=21, help="cases of each kind")
    parser.add_argument("--seed", type=int, default=0, help="of the first case")
    parser.add_argument("--kind", action="append", choices=KINDS)
    parser.add_argument("--severity", type=int, choices=(0, 1, 2))
    parser.add_argument(
        "--radii", type=float, default=0.0, help="sd of the vehicle file's rolling radii [%%]"
    )
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--rows", type=Path, help="append every case to this file, one JSON a line")
    parser.add_argument("--write", type=Path, help="write the cases into this folder, too")
    asked = parser.parse_args()
    asked.kind = asked.kind or list(KINDS)
    return asked


def carry_out(job: Job) -> Row:
    """Draw one case and diagnose it."""
    case = draw(job.kind, job.seed, severity=job.severity)
    off = 0.01 * job.radii * float(np.random.default_rng(job.seed).normal())
    case = replace(case, vehicle=case.vehicle.with_radii(1.0 + off))
    if job.folder:
        write(case, job.folder / f"{job.kind}_{job.seed}")
    start = time.perf_counter()
    try:
        answer, before, after = diagnosed(case)
    except ModuleNotFoundError as error:  # nothing to try yet: the cases alone
        return Row(job.seed, case.answer, None, 0.0, f"not diagnosed: {error}")
    except Exception:
        spent = time.perf_counter() - start
        return Row(job.seed, case.answer, None, spent, traceback.format_exc(limit=-2))
    spent = time.perf_counter() - start
    return Row(job.seed, case.answer, score(case, answer, before, after), spent)


def diagnosed(case: HiddenCase) -> tuple[Mapping[str, Any], Replays, Replays]:
    """Run the program on what it may see."""
    from calib.diagnosis.diagnose import diagnose

    found = diagnose(case.vehicle, list(case.calibration), list(case.holdout))
    return told(found), replays(found.before), replays(found.after)


def replays(logs: Any) -> Replays:
    """Channels by log name."""
    return {log.name: log.channels for log in logs}


def told(diagnosis: Any) -> dict[str, Any]:
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


def goals(scores: list[Score], rows: list[Row]) -> str:
    """The table of goals."""
    single = [s for s in scores if s.kind == "single" and not set(s.truth) & FAINT]
    faint = [s for s in scores if s.kind == "single" and set(s.truth) & FAINT]
    double, triple, none, varied, outside = (
        [s for s in scores if s.kind == kind]
        for kind in ("double", "triple", "none", "varied", "outside")
    )
    groups, grouped, offsets, unlike = (
        [s for s in scores if s.kind == kind]
        for kind in ("groups", "grouped_single", "offsets", "unlike")
    )
    held = [i.held for s in scores for i in s.intervals]
    same = [i.held for s in scores for i in s.intervals if i.same_form]
    slack = [i.held_with_slack for s in scores for i in s.intervals]
    table = [
        ("one effect: exact name", ">= 95", [s.outcome == "exact" for s in single]),
        ("one effect: exact or in the set", "", [s.outcome in ("exact", "set") for s in single]),
        ("one effect: wrong name", "<= 2", [s.outcome == "wrong" for s in single]),
        ("two effects: both exact", ">= 90", [s.outcome == "exact" for s in double]),
        ("two effects: wrong name", "<= 2", [s.outcome == "wrong" for s in double]),
        ("three effects: all exact", ">= 70", [s.outcome == "exact" for s in triple]),
        ("three effects: wrong name", "<= 2", [s.outcome == "wrong" for s in triple]),
        ("nothing hidden: no gap", ">= 99", [s.outcome == "exact" for s in none]),
        ("nothing hidden, other logs: no gap", ">= 99", [s.outcome == "exact" for s in varied]),
        ("logs of two groups: no gap", "", [s.outcome == "exact" for s in groups]),
        ("logs of two groups: a wrong name", "", [s.outcome == "wrong" for s in groups]),
        ("two groups, one effect: exact", "", [s.outcome == "exact" for s in grouped]),
        ("two groups, one effect: wrong name", "", [s.outcome == "wrong" for s in grouped]),
        ("own slopes or zeros, one effect: exact", "", [s.outcome == "exact" for s in offsets]),
        ("own slopes or zeros: wrong name", "", [s.outcome == "wrong" for s in offsets]),
        ("own pads and tyres, one effect: exact", "", [s.outcome == "exact" for s in unlike]),
        ("own pads and tyres: wrong name", "", [s.outcome == "wrong" for s in unlike]),
        ("outside: unknown or a set", ">= 95", [s.passed for s in outside]),
        ("outside: a single wrong name", "<= 2", [s.outcome == "wrong" for s in outside]),
        ("outside: axle right, where said", "", [s.axle for s in outside if s.axle is not None]),
        (
            "outside: driver right, where said",
            "",
            [s.driver for s in outside if s.driver is not None],
        ),
        (f"more than {MOST_LEFT:g} noise units left, not told", "<= 1", [s.silent for s in scores]),
        ("mass, inertia: set or no gap", ">= 95", [s.passed for s in faint]),
        ("intervals hold the truth", "93-97", held),
        ("... of parameters that mean the same in the plant", "93-97", same),
        ("... with slack where forms differ", "", slack),
    ]
    out = ["| | goal % | % | 95 % limits | n |", "|---|---|---|---|---|"]
    out += [row(name, goal, hits) for name, goal, hits in table if hits]
    out += [closed(kind, part) for kind, part in (("one effect", single), ("two effects", double))]
    seconds = [row.seconds for row in rows if row.score is not None]
    out.append(f"| seconds a case, median and worst | <= 10 | {np.median(seconds):.1f} | "
               f"{max(seconds):.1f} | {len(seconds)} |")  # fmt: skip
    return "\n".join(part for part in out if part)


def row(name: str, goal: str, hits: list[bool]) -> str:
    """One line of the table."""
    low, high = wilson(sum(hits), len(hits))
    return (
        f"| {name} | {goal} | {100 * sum(hits) / len(hits):.1f} | "
        f"{100 * low:.1f} to {100 * high:.1f} | {len(hits)} |"
    )


def closed(kind: str, scores: list[Score]) -> str:
    """Median of the closed gap with quartiles, over cases where something was named."""
    values = [s.closed for s in scores if math.isfinite(s.closed)]
    if not values:
        return ""
    low, middle, high = np.percentile(values, [25, 50, 75])
    return (
        f"| {kind}: gap closed, median (quartiles) | >= 95 | {100 * middle:.1f} | "
        f"{100 * low:.1f} to {100 * high:.1f} | {len(values)} |"
    )


def wilson(hits: int, n: int, z: float = 1.959964) -> tuple[float, float]:
    """95 % limits of a share by Wilson's score interval."""
    share = hits / n
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    return max(middle - half, 0.0), min(middle + half, 1.0)


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
    found: dict[tuple[str, str], list[tuple[bool, bool]]] = {}
    for s in scores:
        for i in s.intervals:
            found.setdefault((i.effect, i.parameter), []).append((i.held, i.held_with_slack))
    lines = [
        f"{effect}.{parameter}: {sum(a for a, _ in held)} of {len(held)}, with slack "
        f"{sum(b for _, b in held)}"
        for (effect, parameter), held in sorted(found.items())
    ]
    return "\n".join(["intervals that hold the truth:", *lines])


if __name__ == "__main__":
    main()
