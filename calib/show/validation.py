"""Facts of a validation: the verdict, the ECU beside the best estimate, what comes next."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path

from calib.base.plain import counted, plain, signed_percent
from calib.estimation.agreement import agreement
from calib.estimation.results import unseen_in
from calib.estimation.validate import (
    CALIBRATION,
    HOLDOUT,
    NO_HOLDOUT,
    NONE,
    REFERENCE,
    TRUTH,
    Validation,
    proof_of,
)
from calib.show.facts import FAILED, PASSED, WARNING, WORDS, Facts, Row, Table
from calib.show.judged import UNKNOWN, broken, budget_rows, mean_of, pads, stop_by_stop, valid, word
from calib.show.origin import origin
from calib.show.stop import pads_over_time
from calib.store.evidence import CONSISTENT
from calib.store.state import DRAFT
from calib.store.version import Stored
from calib.table.budget import STOP, advice_lines, limiting
from calib.table.exported import Precision
from calib.table.unseen import unseen_line

_PROOFS = {
    TRUTH: "the torques in the logs",
    REFERENCE: "the speed v, which cannot show an error of the ramp itself",
    NONE: "nothing: the logs hold neither torques nor v",
}
_V_NOT_USED = "nothing: no torques, and v is late, held or beside no sample that is valid"
"""Of logs with v that prove nothing."""
_SHOWN = 4
"""Limits that are broken, in the head of the answer; all are in the details."""


@dataclass(frozen=True)
class Validated:
    """A table judged by logs and ``files`` by role, as exported (``how``) or in full."""

    stored: Stored
    results: Sequence[Validation]
    how: Precision | None = None
    files: Mapping[str, Path] = field(default_factory=dict)


def facts(judged: Validated) -> Facts:
    """The verdict, stop by stop, with each warning."""
    stored, results, how = judged.stored, judged.results, judged.how
    found = sorted(results, key=lambda result: result.passed)
    logs, (limits, unknown) = [(r.role, r.log, r.digest) for r in results], stop_by_stop(results)
    warnings = [*stored.table.warnings, *(w for result in results for w in result.all_warnings)]
    failed, proof = not all(result.passed for result in found), proof_of(list(results))
    verdict = FAILED if failed else WARNING if warnings else PASSED
    budgets = [result.budget for result in found if result.budget]
    advice = advice_lines((of for budget in budgets for of in budget), STOP)
    details = Facts(
        "The ECU beside the best estimate; 95 % intervals",
        tables=[_beside_best(stored, found)],
        rows=[
            ("table", f"{stored.id}, {stored.state.why}"),
            ("vehicle", stored.table.vehicle.name),
            ("mass", str(found[0].mass)),
            *_limiting(found),
            ("seen by", unseen_line(unseen_in(stored, results))),
        ],
        notes=advice,
    )
    return Facts(
        title=f"Validation of {stored.id}",
        headline=_outcome(stored, found),
        verdict=verdict,
        word=CONSISTENT.capitalize() if proof == NONE and not failed else WORDS[verdict],
        tables=[by_stop(stored, found)],
        rows=[
            *[row for result in found for row in _against(result)][:_SHOWN],
            *(
                [("judged by", _judged_by(results, proof))]
                if any(r.role == HOLDOUT for r in found)
                else []
            ),
            *([] if how is None else [("as exported", str(how))]),
            *(("limited by", limiting(budget)) for budget in budgets[:1]),
        ],
        next=_next(stored, found),
        warnings=warnings,
        parts=[
            details,
            Facts("Metrics and limits", tables=[limits], notes=unknown),
            Facts("The stops", pictures=[pads_over_time(r) for r in results]),
            origin(stored, logs, date.today().isoformat(), judged.files),
        ],
    )


def _judged_by(results: Sequence[Validation], proof: str) -> str:
    """What the verdict rests on."""
    with_v = any("v" in result.estimate.ran.log for result in results)
    return _V_NOT_USED if proof == NONE and with_v else _PROOFS[proof]


def _outcome(stored: Stored, results: list[Validation]) -> str:
    """On how many stops the table holds its limits; of one stop, how its pads changed."""
    failed, of = [result.log for result in results if not result.passed], len(results)
    told = f"{stored.id} holds on {of - len(failed)} of {counted(of, 'stop')}"
    if of == 1 and not failed and (change := _change(stored, results[0])) is not None:
        whole = round(100.0 * abs(change))
        how = f"{whole} % {'weaker' if change < 0.0 else 'stronger'} than" if whole else "as"
        told += f"; pads {how} on the ramp"
    return told


def _change(stored: Stored, r: Validation) -> float | None:
    """Pad level of the ECU in a stop over that of the ramp, less 1."""
    level = r.figures["ecu_pad_level"] if r.figures["valid_share"] else None
    return None if level is None else level / stored.table.calibration.pad_scale.value - 1.0


def _next(stored: Stored, results: list[Validation]) -> str:
    """What follows: stops with other pads than the ramp's prove nothing of its table."""
    together = agreement(results)
    if any(result.role == CALIBRATION for result in results):
        return "validate again without the logs of the fit"
    if failed := [result for result in results if not result.passed]:
        return f"look at {failed[0].log}: brake-cal plot {stored.id} LOG"
    if together is not None and together.differ:
        return "find out why the pads differ between the stops of one road, and validate again"
    if stored.state.word != DRAFT:
        return f"nothing; {stored.id} is {stored.state.word}"
    if any(result.all_warnings for result in results):
        return "look at the warnings; release the table where none speaks against it"
    return f"brake-cal tables release {stored.id} --reason ... --evidence DIR/summary.json"


def by_stop(stored: Stored, results: Sequence[Validation]) -> Table:
    """What an ECU makes of each stop."""
    rows = []
    for r in results:
        change = _change(stored, r)
        rows.append(
            (
                r.log,
                *(pads(r.figures, axle, "ecu_") for axle in "fr"),
                UNKNOWN if change is None else signed_percent(change),
                valid(r.figures),
                word(r),
            )
        )
    heads = ("stop", "front pads", "rear pads", "since ramp", "valid", "verdict")
    return Table(heads, rows, verdicts=[PASSED if r.passed else FAILED for r in results])


def _beside_best(stored: Stored, results: list[Validation]) -> Table:
    """Of each stop the ECU, the best estimate, its change since the ramp, and the truth."""
    rows = [(r.log, *cells) for r in results for cells in _of_one(stored, r)]
    return Table(("stop", "", "front pads", "rear pads", "pad level", "valid"), rows)


def _of_one(stored: Stored, r: Validation) -> Iterator[Sequence[str]]:
    of, cal = r.figures, stored.table.calibration
    level = mean_of(of, "ecu_pad_level", "ecu_interval_level")
    ecu = [pads(of, "f", "ecu_"), pads(of, "r", "ecu_"), level]
    yield "ECU", *ecu, valid(of)
    with_v = "best, with v" if r.estimate.blocks.v is not None else "best, without v"
    best = [pads(of, "f"), pads(of, "r"), mean_of(of, "pad_level", "interval_level")]
    yield with_v, *best, plain("valid_share").with_unit(of["valid_share"])
    then = {"f": cal.pad_friction_f.value, "r": cal.pad_friction_r.value}
    now = {axle: of[f"pad_friction_{axle}"] for axle in then}
    change = [signed_percent(x / then[axle] - 1.0) for axle, x in now.items() if x is not None]
    if len(change) == len(then):
        yield "since the ramp", *change, "", ""
    true = [of[name] for name in ("true_pad_friction_f", "true_pad_friction_r", "true_pad_level")]
    if any(x is not None for x in true):
        yield "truth", *("" if x is None else f"{x:.3f}" for x in true), ""


def _against(r: Validation) -> Iterator[Row]:
    """What makes a stop fail."""
    for text in [NO_HOLDOUT] if r.role == CALIBRATION else broken(r):
        yield r.log, text


def _limiting(results: list[Validation]) -> list[Row]:
    """What stands beside the table: limits that are not held, what the intervals are made of."""
    rows: list[Row] = []
    for r in results:
        rows += _against(r)
        rows += [
            (r.log, f"{100.0 * share:.0f} % of the braked samples are not valid: {why}")
            for why, share in r.refused.items()
        ]
        rows += budget_rows(r.budget or (), f"{r.log}, ")
    together = agreement(results)
    return rows + [
        (
            ", ".join(road.stops),
            "on roads alike, pad friction differs from the mean by up to "
            f"{100.0 * road.spread_f:.1f} % front and {100.0 * road.spread_r:.1f} % rear",
        )
        for road in (together.roads if together else ())
        if road.spread_f is not None and road.spread_r is not None
    ]
