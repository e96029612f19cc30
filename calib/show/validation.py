"""Facts of a validation: the verdict, the ECU beside the best estimate, what comes next."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path

from calib.base.names import AXLE_NAMES
from calib.base.plain import counted, metric_of, signed_percent
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
from calib.show import torque
from calib.show.facts import FAILED, PASSED, WARNING, WORDS, Facts, Row, Table
from calib.show.judged import UNKNOWN, broken, pads, stop_by_stop, valid, word
from calib.show.origin import origin
from calib.show.stop import stops_on_map, torque_and_pads
from calib.store.evidence import CONSISTENT
from calib.store.state import DRAFT
from calib.store.version import Stored
from calib.table.budget import STOP, advice_lines, limiting_parts
from calib.table.exported import Precision
from calib.table.unseen import unseen_line

_PROOFS = {
    TRUTH: "the torques in the logs",
    REFERENCE: "the estimate with the speed v; no torque was measured, so an error of the table "
    "itself would not show",
    NONE: "nothing: the logs hold neither torques nor v",
}
_V_NOT_USED = "nothing: no torques, and v is late, held or beside no sample that is valid"
"""What logs with a v that cannot be used are checked against."""
_BESIDE = "Means over the valid samples with 95 % intervals; an ECU has no speed v."


@dataclass(frozen=True)
class Validated:
    """A table judged by logs, in full or as exported (``how``); other ``files`` by role."""

    stored: Stored
    results: Sequence[Validation]
    how: Precision | None = None
    files: Mapping[str, Path] = field(default_factory=dict)


def validation_facts(judged: Validated) -> Facts:
    """The verdict, stop by stop, with each warning."""
    stored, results, how = judged.stored, judged.results, judged.how
    in_order = sorted(results, key=lambda result: result.passed)
    logs, (limits, unknown) = [(r.role, r.log, r.digest) for r in results], stop_by_stop(results)
    warnings = [*stored.table.warnings, *(w for result in results for w in result.all_warnings)]
    failed, proof = not all(result.passed for result in in_order), proof_of(list(results))
    verdict = FAILED if failed else WARNING if warnings else PASSED
    budgets = [result.budget for result in in_order if result.budget]
    broken_limits = {r.log: [NO_HOLDOUT] if r.role == CALIBRATION else broken(r) for r in in_order}
    rows = [(log, text) for log, texts in broken_limits.items() for text in texts]
    if any(result.role == HOLDOUT for result in in_order):
        v_unused = proof == NONE and any("v" in r.estimate.ran.log for r in results)
        rows.append(("checked against", _V_NOT_USED if v_unused else _PROOFS[proof]))
    rows += [("as exported", str(how))] if how else []
    rows += [("largest uncertainty", limiting_parts(budget)) for budget in budgets[:1]]
    rows.append(("unseen errors", unseen_line(unseen_in(stored, results))))
    details = Facts(
        "The ECU beside the best estimate",
        tables=[beside_best(stored, in_order)],
        rows=[
            ("table", f"{stored.id}, {stored.state.with_reason}"),
            ("mass", str(in_order[0].mass)),
            *_limiting(in_order),
        ],
        notes=advice_lines((of for budget in budgets for of in budget), STOP),
    )
    return Facts(
        title=f"Validation of {stored.id}",
        headline=_outcome(stored, in_order),
        verdict=verdict,
        word=CONSISTENT.capitalize() if proof == NONE and not failed else WORDS[verdict],
        tables=[by_stop(in_order)],
        rows=rows,
        next=_next(stored, in_order),
        warnings=warnings,
        parts=[
            Facts("The stops", pictures=[*map(torque_and_pads, results), stops_on_map(results)]),
            details,
            Facts("Metrics and limits", tables=[limits], notes=unknown),
            origin(stored, logs, date.today().isoformat(), judged.files),
        ],
    )


def _outcome(stored: Stored, results: list[Validation]) -> str:
    """On how many stops the table holds its limits; torques, their errors, change of the pads."""
    failed, stops = [result.log for result in results if not result.passed], len(results)
    texts = [f"{stored.id} holds on {stops - len(failed)} of {counted(stops, 'stop')}"]
    if stops == 1:
        answer = torque.in_words(torque.ecu_means(results[0]))
        texts += [answer] * bool(answer)
    if compared := [one for one in map(torque.errors, results) if one.values]:
        worst = max(compared, key=lambda one: max(one.values[:2]))
        texts.append(f"front / rear within {worst.of_axles} of {torque.AGAINST[worst.against]}")
    if stops == 1 and not failed and (change := _change(stored, results[0])) is not None:
        percent = round(100.0 * abs(change))
        how = f"{percent} % {'weaker' if change < 0.0 else 'stronger'} than" if percent else "as"
        texts.append(f"pads {how} on the ramp")
    return "; ".join(texts)


def _change(stored: Stored, r: Validation) -> float | None:
    """Pad level of the ECU in a stop over that of the ramp, less 1."""
    level = r.figures["ecu_pad_level"] if r.figures["valid_share"] else None
    return None if level is None else level / stored.table.calibration.pad_scale.value - 1.0


def _next(stored: Stored, results: list[Validation]) -> str:
    """Next step; stops whose pads differ prove nothing of a table."""
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


def by_stop(results: Sequence[Validation]) -> Table:
    """Brake torques of each stop as an ECU has them, and the error of the total."""
    rows = [
        (r.log, *torque.ecu_means(r), torque.errors(r).of_axles, valid(r.figures), word(r))
        for r in results
    ]
    heads = ("stop", *torque.HEADS, "error front / rear", "valid", "verdict")
    return Table(heads, rows, verdicts=[PASSED if r.passed else FAILED for r in results])


def beside_best(stored: Stored, results: Sequence[Validation]) -> Table:
    """Torques and pads of each stop: of the ECU, of the best estimate, and as they are."""
    rows = [(r.log, *cells) for r in results for cells in _answers(stored, r)]
    pads_of = [f"{axle} pads" for axle in AXLE_NAMES.values()]
    heads = ("stop", "answer", *torque.HEADS, *pads_of, "since ramp", "valid")
    return Table(heads, rows, _BESIDE)


def _answers(stored: Stored, r: Validation) -> Iterator[Sequence[str]]:
    figures, columns, used = r.figures, r.estimate.columns(), torque.valid_samples(r)
    change = _change(stored, r)
    since = UNKNOWN if change is None else signed_percent(change)
    yield (
        *("ECU", *torque.means(columns, used), *(pads(figures, axle, "ecu_") for axle in "fr")),
        *(since, valid(figures)),
    )
    with_v = "best, with v" if r.estimate.blocks.v is not None else "best, without v"
    share = metric_of("valid_share").with_unit(figures["valid_share"])
    yield (
        *(with_v, *torque.means(columns, used & r.estimate.valid, "")),
        *(*(pads(figures, axle) for axle in "fr"), "", share),
    )
    if (error := torque.errors(r)).values:
        yield f"ECU against {torque.AGAINST[error.against]}", *error.texts, *[""] * 4
    if true := torque.true_means(r, used):
        names = ("true_pad_friction_f", "true_pad_friction_r")
        pads_ = ("" if figures[name] is None else f"{figures[name]:.3f}" for name in names)
        yield "truth", *true, *pads_, "", ""


def _limiting(results: list[Validation]) -> list[Row]:
    """Samples that are not valid, and agreement."""
    together = agreement(results)
    return [
        *(
            (r.log, f"{100.0 * share:.0f} % of the braked samples are not valid: {why}")
            for r in results
            for why, share in r.refused.items()
        ),
        *(
            (
                ", ".join(road.stops),
                "on roads alike, pad friction differs from the mean by up to "
                f"{100.0 * road.spread_f:.1f} % front and {100.0 * road.spread_r:.1f} % rear",
            )
            for road in (together.roads if together else ())
            if road.spread_f is not None and road.spread_r is not None
        ),
    ]
