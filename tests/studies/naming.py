"""How often the hidden effect is named, on cases of the plant in tests/support/hidden.

    python tests/studies/naming.py --count 42 --seed 1 [--jobs 2]
    python tests/studies/naming.py --count 9 --seed 5 --kind outside
    python tests/studies/naming.py --count 21 --kind single --severity 0 --unlike-tyres

``--count`` cases of each kind; successive seeds go round the names. ``--unlike-tyres`` gives each
axle one of Burckhardt's, Dugoff's or a brush. Limits are Wilson's, 95 %. A case that ends with an
error is an outcome like any other. Outcomes:

    exact      named, and the names are those hidden; for `none`, no gap; for `outside`, unknown
    set        what is hidden is among the names and those said to be indistinguishable from them;
               for `outside`, an honest set
    partial    of several hidden effects some are named and nothing else
    no_gap     a gap was hidden and not seen
    unknown    an effect of the catalogue was not recognised
    wrong      another name was given, and the hidden one is not even in the set
"""

import math
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.diagnosis import Diagnosis
from tests.studies.study import arguments, carried_out, share
from tests.support.hidden.cases import KINDS, HiddenCase, draw
from tests.support.hidden.settings import Hidden

PARAMETERS: dict[str, Callable[[Hidden], float]] = {
    "drag_area": lambda h: h.drag_area,
    "coefficient": lambda h: h.rolling,
    "grade": lambda h: math.sin(math.atan(h.grade)),
    "drag_torque": lambda h: h.engine_torque,
    "fade_slope": lambda h: h.fade,
    "fade_onset": lambda h: h.fade_onset,
    "speed_slope": lambda h: h.speed_slope,
    "pressure_slope": lambda h: h.pressure_slope,
    "wet_loss": lambda h: h.wet_loss,
    "dry_energy": lambda h: h.dry_energy,
    "radius_mismatch": lambda h: h.radius_mismatch,
    "threshold": lambda h: h.threshold,
    "time_constant": lambda h: h.lag + h.lag_behind,
    "delay": lambda h: h.delay,
    "knee_slope": lambda h: h.knee_slope,
    "knee": lambda h: h.knee,
    "natural_frequency": lambda h: 2.0 * math.pi * h.pitch_frequency,
    "damping": lambda h: h.pitch_damping,
    "pitch_gradient": lambda h: h.pitch_gain,
    "bias": lambda h: h.bias,
    "scale_error": lambda h: h.scale_error,
    "extra_inertia": lambda h: h.inertia,
    "imbalance": lambda h: h.imbalance,
    "amplitude": lambda h: h.thickness,
    "mass_error": lambda h: h.mass_error,
    "residual_pressure": lambda h: h.sticking,
    "response_time": lambda h: 1.0 / (2.0 * math.pi * h.surge),
    "line_damping": lambda h: h.surge_damping,
    "radius_load": lambda h: h.radius_load,
    "runout": lambda h: h.tooth_error,
    "filter_time": lambda h: math.sqrt(2.0) / (2.0 * math.pi * h.filter_frequency),
    "v_delay": lambda h: h.v_late,
    "omega_delay": lambda h: 0.5 * h.wheel_window,
    "regen_torque": lambda h: 2.0 * h.regen_torque,
    "regen_power": lambda h: 2.0 * h.regen_power,
}
"""True values of parameters of the catalogue, SI, in the terms of the plant; where the plant goes
its own way, as in rolling, fade or wetness, none is exactly right."""


@dataclass(frozen=True)
class Job:
    """What one worker is asked."""

    kind: str
    seed: int
    severity: int | None
    unlike_tyres: bool


@dataclass(frozen=True)
class Row:
    """One case: what was hidden, outcome, what was said, intervals by parameter, duration [s]."""

    kind: str
    seed: int
    truth: str
    outcome: str
    named: str
    intervals: dict[str, bool]
    seconds: float


def tried(job: Job) -> Row:
    """Draw one case and diagnose it."""
    case = draw(job.kind, job.seed, severity=job.severity, unlike_tyres=job.unlike_tyres)
    truth, start = "+".join(sorted(case.effects)) or "nothing", time.perf_counter()
    try:
        diagnosis = diagnose(case.vehicle, list(case.calibration), list(case.holdout))
    except Exception as error:
        return Row(job.kind, job.seed, truth, "error", repr(error)[:100], {}, 0.0)
    seconds = time.perf_counter() - start
    named = "+".join(sorted(effect.name for effect in diagnosis.effects)) or diagnosis.verdict
    inside = intervals(case, diagnosis)
    return Row(job.kind, job.seed, truth, outcome(case, diagnosis), named, inside, seconds)


def outcome(case: HiddenCase, diagnosis: Diagnosis) -> str:
    """One of the words above."""
    truth, named = set(case.effects), {effect.name for effect in diagnosis.effects}
    reported = named.union(*(effect.indistinguishable_from for effect in diagnosis.effects))
    if case.kind == "outside":
        words = {"unknown": "exact", "ambiguous": "set", "no_gap": "no_gap"}
        return words.get(diagnosis.verdict, "wrong")
    if diagnosis.verdict in ("no_gap", "unknown"):
        return "exact" if diagnosis.verdict == "no_gap" and not truth else diagnosis.verdict
    if diagnosis.verdict == "named" and named == truth:
        return "exact"
    if truth and truth <= reported:
        return "set"
    return "partial" if named < truth else "wrong"


def intervals(case: HiddenCase, diagnosis: Diagnosis) -> dict[str, bool]:
    """Whether the 95 % interval of each parameter of a rightly named effect holds the truth."""
    inside = {}
    for effect in diagnosis.effects:
        for name, parameter in effect.parameters.items():
            if effect.name in case.effects and name in PARAMETERS:
                low, high = parameter.ci95
                true = PARAMETERS[name](case.hidden)
                inside[f"{effect.name}.{name}"] = bool(low <= true <= high)
    return inside


def report(rows: list[Row]) -> None:
    """Outcomes and durations by kind, what was taken for what, intervals by parameter."""
    print("| hidden | exact, % (95 % limits, n) | wrong, % | median time, worst [s] |")
    print("|---|---|---|---|")
    for kind in dict.fromkeys(row.kind for row in rows):
        of_kind = [row for row in rows if row.kind == kind]
        exact, wrong = (share([r.outcome == word for r in of_kind]) for word in ("exact", "wrong"))
        seconds = [row.seconds for row in of_kind]
        print(f"| {kind} | {exact} | {wrong} | {np.median(seconds):.1f}, {max(seconds):.1f} |")
    missed = Counter(f"{r.truth} -> {r.outcome}: {r.named}" for r in rows if r.outcome != "exact")
    print("\nnot exact:", *(f"{n:4} x {text}" for text, n in sorted(missed.items())), sep="\n")
    inside: dict[str, list[bool]] = {}
    for name, hit in (pair for row in rows for pair in row.intervals.items()):
        inside.setdefault(name, []).append(hit)
    print(
        f"\nintervals that hold the truth: {share([x for hits in inside.values() for x in hits])}"
    )
    for name, hits in sorted(inside.items()):
        print(f"{name}: {sum(hits)} of {len(hits)}")


def main() -> None:
    """Run the study."""
    options = arguments(
        __doc__, "unlike_tyres", count=21, seed=0, severity=-1, jobs=1, kind=list(KINDS)
    )
    severity = None if options.severity < 0 else options.severity
    jobs = [
        Job(kind, options.seed + i, severity, options.unlike_tyres)
        for kind in options.kind
        for i in range(options.count)
    ]
    rows = []
    for row in carried_out(tried, jobs, options.jobs):
        print(f"{row.seed:6} {row.truth}: {row.outcome}, {row.named}", file=sys.stderr, flush=True)
        rows.append(row)
    report(rows)


if __name__ == "__main__":
    main()
