"""Facts of a validation: the verdict, torques stop by stop, the next step, all metrics.

Two estimates are compared: that of the ECU, without the speed v, and the best, with all channels.
"""

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
from calib.show.judged import broken_limits, origin, pads, stop_by_stop, valid_share, verdict_word
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
"""What the torques of the ECU are checked against, in words."""
_V_NOT_USED = "nothing: no torques, and v is late, held, or missing where samples are valid"
"""The words for `NONE` if there is a v that cannot be used."""
_MEANS = "Means over the valid samples with 95 % intervals; an ECU has no speed v."


@dataclass(frozen=True)
class Validated:
    """A stored table, and the ``results`` of judging it on logs."""

    stored: Stored
    results: Sequence[Validation]
    precision: Precision | None = None  # of the export that was judged; None for full
    files: Mapping[str, Path] = field(default_factory=dict)  # other inputs by their roles


def validation_facts(judged: Validated) -> Facts:
    """Return verdict, torques of each stop, pictures, metrics and warnings, failed stops first."""
    stored, results = judged.stored, judged.results
    in_order = sorted(results, key=lambda result: result.passed)
    logs = [(result.role, result.log, result.digest) for result in results]
    metrics, notes = stop_by_stop(results)
    warnings = [*stored.table.warnings, *(w for result in results for w in result.all_warnings)]
    failed, proof = not all(result.passed for result in results), proof_of(list(results))
    verdict = WARNING if warnings else PASSED
    if failed:
        verdict = FAILED
    budgets = [axle for result in in_order for axle in result.budget or ()]
    table = f"{stored.id}, {stored.state.with_reason}"
    details = Facts(
        "The ECU beside the best estimate",
        tables=[beside_best(stored, in_order)],
        rows=[("table", table), ("mass", str(in_order[0].mass)), *_limitations(in_order)],
        notes=advice_lines(budgets, STOP),
    )
    return Facts(
        title=f"Validation of {stored.id}",
        headline=_outcome(stored, in_order),
        verdict=verdict,
        word=CONSISTENT.capitalize() if proof == NONE and not failed else WORDS[verdict],
        tables=[by_stop(in_order)],
        rows=_rows(judged, in_order, proof),
        next=_next(stored, in_order),
        warnings=warnings,
        parts=[
            Facts("The stops", pictures=[*map(torque_and_pads, results), stops_on_map(results)]),
            details,
            Facts("Metrics and limits", tables=[metrics], notes=notes),
            origin(stored, logs, date.today().isoformat(), judged.files),
        ],
    )


def _rows(judged: Validated, results: Sequence[Validation], proof: str) -> list[Row]:
    """Return the limits that each log breaks, and what the verdict rests on."""
    rows = list[Row]()
    budgets = [result.budget for result in results if result.budget]
    for result in results:
        reasons = [NO_HOLDOUT] if result.role == CALIBRATION else broken_limits(result.judgements)
        rows += [(result.log, reason) for reason in reasons]
    if any(result.role == HOLDOUT for result in results):
        has_unused_v = proof == NONE and any("v" in r.estimate.corrected.log for r in results)
        rows.append(("checked against", _V_NOT_USED if has_unused_v else _PROOFS[proof]))
    if judged.precision:
        rows.append(("as exported", str(judged.precision)))
    if budgets:
        rows.append(("largest uncertainty", limiting_parts(budgets[0])))
    return [*rows, ("unseen errors", unseen_line(unseen_in(judged.stored, judged.results)))]


def _outcome(stored: Stored, results: list[Validation]) -> str:
    """Return on how many stops the table holds, and the largest error of the torques."""
    passed, stops = sum(result.passed for result in results), len(results)
    texts = [f"{stored.id} holds on {passed} of {counted(stops, 'stop')}"]
    if stops == 1:  # its torques here, the change of its pads at the end
        texts.append(torque.in_words(torque.ecu_means(results[0])))
    compared = [errors for errors in map(torque.errors, results) if errors.values]
    if compared:
        worst = max(compared, key=lambda errors: max(errors.values[:2]))
        texts.append(f"front / rear within {worst.of_axles} of {torque.AGAINST[worst.against]}")
    change = _change(stored, results[0])
    if stops == passed == 1 and change is not None:
        percent, word = round(100.0 * abs(change)), "weaker" if change < 0.0 else "stronger"
        compared_with_ramp = f"{percent} % {word} than" if percent else "as"
        texts.append(f"pads {compared_with_ramp} on the ramp")
    return "; ".join(filter(None, texts))


def _change(stored: Stored, result: Validation) -> float | None:
    """Return the change of the ECU's pad level since the ramp [1]; None if it is not known."""
    level = result.figures["ecu_pad_level"] if result.figures["valid_share"] else None
    return None if level is None else level / stored.table.calibration.pad_scale.value - 1.0


def _next(stored: Stored, results: list[Validation]) -> str:
    """Return the next step; stops of one road whose pads differ do not prove a table."""
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
    """Return a table with the ECU's brake torques in each stop, and their errors."""
    rows = []
    for r in results:
        share, verdict = valid_share(r.figures), verdict_word(r)
        rows.append((r.log, *torque.ecu_means(r), torque.errors(r).of_axles, share, verdict))
    heads = ("stop", *torque.HEADS, "error front / rear", "valid", "verdict")
    return Table(heads, rows, verdicts=[PASSED if r.passed else FAILED for r in results])


def beside_best(stored: Stored, results: Sequence[Validation]) -> Table:
    """Return a table with torques and pads of each stop: ECU, best estimate, error, truth."""
    rows = [(result.log, *cells) for result in results for cells in _answers(stored, result)]
    pads_of = [f"{axle} pads" for axle in AXLE_NAMES.values()]
    heads = ("stop", "answer", *torque.HEADS, *pads_of, "since ramp", "valid")
    return Table(heads, rows, _MEANS)


def _answers(stored: Stored, r: Validation) -> Iterator[Sequence[str]]:
    """Yield the rows of a stop in `beside_best`, without the name of the stop."""
    figures, columns, ecu_valid = r.figures, r.estimate.columns(), r.estimate.ecu_valid
    change = _change(stored, r)
    since = torque.UNKNOWN if change is None else signed_percent(change)
    ecu_pads = [pads(figures, axle, "ecu_") for axle in "fr"]
    yield "ECU", *torque.means(columns, ecu_valid), *ecu_pads, since, valid_share(figures)
    best = "best, with v" if r.estimate.run.blocks.v is not None else "best, without v"
    best_torques = torque.means(columns, ecu_valid & r.estimate.valid, prefix="")
    best_pads = [pads(figures, axle) for axle in "fr"]
    best_share = metric_of("valid_share").with_unit(figures["valid_share"])
    yield best, *best_torques, *best_pads, "", best_share
    error = torque.errors(r)
    if error.values:
        yield f"ECU against {torque.AGAINST[error.against]}", *error.texts, "", "", "", ""
    if true := torque.true_means(r, ecu_valid):
        values = [figures[f"true_pad_friction_{axle}"] for axle in "fr"]
        true_pads = ["" if value is None else f"{value:.3f}" for value in values]
        yield "truth", *true, *true_pads, "", ""


def _limitations(results: list[Validation]) -> list[Row]:
    """Return why samples are not valid, and how the pads of stops on one road differ."""
    rows = [
        (result.log, f"{100.0 * share:.0f} % of the braked samples are not valid: {reason}")
        for result in results
        for reason, share in result.refused.items()
    ]
    together = agreement(results)
    for road in together.roads if together else ():
        if road.spread_f is not None and road.spread_r is not None:
            differ = f"{100.0 * road.spread_f:.1f} % front and {100.0 * road.spread_r:.1f} % rear"
            text = f"on roads alike, pad friction differs from the mean by up to {differ}"
            rows.append((", ".join(road.stops), text))
    return rows
