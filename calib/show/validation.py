"""Facts of a validation: the verdict, the ECU beside the best estimate, what comes next."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from calib.base.names import AXLE_NAMES
from calib.base.plain import counted, plain, signed_percent
from calib.estimation.agreement import agreement
from calib.estimation.validate import (
    CALIBRATION,
    NO_HOLDOUT,
    NONE,
    REFERENCE,
    TRUTH,
    Validation,
    proof_of,
)
from calib.show.facts import FAILED, PASSED, WARNING, WORDS, Facts, Row, Table
from calib.show.judged import broken, judged, mean_of, pads, word
from calib.show.origin import PageOrigin
from calib.show.origin import origin as origin_of
from calib.show.stop import pads_over_time
from calib.store.evidence import CONSISTENT
from calib.store.state import DRAFT
from calib.store.version import Stored
from calib.table.budget import advice_lines, words
from calib.table.exported import Precision

_BY_STOP = "What an ECU makes of the table, beside the best estimate; 95 % intervals."
_PROOFS = {
    TRUTH: "the torques in the logs",
    REFERENCE: "v, which shows a contradiction, but no error that the ramp made",
    NONE: "nothing: the logs hold neither torques nor v",
}


def facts(stored: Stored, results: Sequence[Validation], how: Precision | None = None) -> Facts:
    """A table judged by logs, as exported (``how``) or in full; each warning is among them."""
    found = list(results)
    warnings = [*stored.table.warnings, *(w for result in found for w in result.all_warnings)]
    failed, proof = not all(result.passed for result in found), proof_of(found)
    verdict = FAILED if failed else WARNING if warnings else PASSED
    return Facts(
        title=f"Validation of {stored.id}",
        headline=_outcome(stored, found),
        verdict=verdict,
        word=CONSISTENT.capitalize() if proof == NONE and not failed else WORDS[verdict],
        tables=[_by_stop(stored, found)],
        rows=[
            ("Judged by", _PROOFS[proof]),
            ("Table", f"{stored.id}, {stored.state.why}"),
            *([] if how is None else [("As exported", str(how))]),
            ("Vehicle", stored.table.vehicle.name),
            ("Mass", str(found[0].mass)),
            *_limiting(found),
            *_by_curves(found),
        ],
        notes=advice_lines(of for result in found for of in result.budget or ()),
        warnings=warnings,
    )


def report(
    stored: Stored,
    results: Sequence[Validation],
    origin: PageOrigin,
    how: Precision | None = None,
) -> Facts:
    """The facts with a part for each stop, and with their origin."""
    logs = [(r.role, r.log, r.digest) for r in results]
    parts = [*map(_stop, results), origin_of(origin, stored, logs)]
    return replace(facts(stored, results, how), parts=parts)


def _outcome(stored: Stored, results: list[Validation]) -> str:
    """How many logs are within the limits, and what comes next.

    Stops with other pads than the ramp's prove nothing of its table.
    """
    failed, of = [result.log for result in results if not result.passed], len(results)
    together = agreement(results)
    if any(result.role == CALIBRATION for result in results):
        then = "next: validate again without the logs of the fit"
    elif failed:
        then = f"not {', '.join(failed)}; next: look at it with brake-cal check and brake-cal plot"
    elif together is not None and together.differ:
        then = (
            "next: find out why the pads differ between the stops of one road, and validate again"
        )
    elif stored.state.word != DRAFT:
        then = f"{stored.id} is {stored.state.word}"
    else:
        then = (
            f"next: brake-cal tables release {stored.id} --reason ... --evidence DIR/summary.json"
        )
        if any(result.all_warnings for result in results):
            then += ", where no warning speaks against the table"
    return f"{of - len(failed)} of {counted(of, 'log')} within the limits; {then}"


def _by_stop(stored: Stored, results: list[Validation]) -> Table:
    """Of each stop the ECU, the best estimate, its change since the ramp, and the truth."""
    rows, colours = [], []
    for r in results:
        colour = PASSED if r.passed else FAILED
        for cells in _of_one(stored, r):
            rows.append((r.log, *cells))
            colours.append(colour)
    heads = ("stop", "", "front pads", "rear pads", "pad level", "valid", "verdict")
    return Table(heads, rows, _BY_STOP, colours)


def _of_one(stored: Stored, r: Validation) -> Iterator[Sequence[str]]:
    of, cal = r.figures, stored.table.calibration
    level = mean_of(of, "ecu_pad_level", "ecu_interval_level")
    ecu = [pads(of, "f", "ecu_"), pads(of, "r", "ecu_"), level]
    share = plain("valid_share").with_unit
    yield "ECU", *_known(ecu), share(of["ecu_valid_share"]), word(r)
    with_v = "best, with v" if r.estimate.blocks.v is not None else "best, without v"
    best = [pads(of, "f"), pads(of, "r"), mean_of(of, "pad_level", "interval_level")]
    yield with_v, *_known(best), share(of["valid_share"]), ""
    then = {"f": cal.pad_friction_f.value, "r": cal.pad_friction_r.value}
    now = {axle: of[f"pad_friction_{axle}"] for axle in then}
    change = [signed_percent(x / then[axle] - 1.0) for axle, x in now.items() if x is not None]
    if len(change) == len(then):
        yield "since the ramp", *change, "", "", ""
    true = [of[name] for name in ("true_pad_friction_f", "true_pad_friction_r", "true_pad_level")]
    if any(x is not None for x in true):
        yield "truth", *("" if x is None else f"{x:.3f}" for x in true), "", ""


def _known(cells: Sequence[str | None]) -> list[str]:
    return [cell or "not known" for cell in cells]


def _limiting(results: list[Validation]) -> list[Row]:
    """What stands beside the table: limits that are not held, what the intervals are made of."""
    rows = []
    for r in results:
        rows += [(r.log, text) for text in ([NO_HOLDOUT] if r.role == CALIBRATION else broken(r))]
        rows += [
            (r.log, f"{100.0 * share:.0f} % of the braked samples are not valid: {why}")
            for why, share in r.refused.items()
        ]
        rows += [
            (f"{r.log}, {name} pads", words(of))
            for name, of in zip(AXLE_NAMES.values(), r.budget or (), strict=False)
        ]
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


_AGAINST = {TRUTH: "the truth", REFERENCE: "the estimate with v"}


def _by_curves(results: list[Validation]) -> Iterator[Row]:
    """What who uses the curves alone has to expect, of the stop where it is most."""
    told = [r for r in results if "gradient_paper" in r.baselines]
    if told:
        worst = max(told, key=lambda r: max(r.baselines["gradient_paper"]))
        law, ecu = (_percent(worst.baselines[name]) for name in ("gradient_paper", "ecu"))
        yield (
            "f1, f2 without the map",
            f"{worst.log}: {law[0]} front, {law[1]} rear off {_AGAINST[worst.compared_with]} by "
            f"the law (23)-(25); the ECU with the map {ecu[0]}, {ecu[1]}",
        )


def _beside(r: Validation) -> list[Table]:
    """The methods beside the estimate, with their errors."""
    if not r.baselines:
        return []
    rows = [(name, *_percent(error)) for name, error in r.baselines.items()]
    against = _AGAINST[r.compared_with]
    caption = f"Rms error of the pad friction of other methods against {against}, not judged."
    return [Table(("method", "front", "rear"), rows, caption)]


def _percent(errors: tuple[float, float]) -> list[str]:
    return [f"{100.0 * x:.1f} %" for x in errors]


def _stop(r: Validation) -> Facts:
    """One stop: judged metrics, the others, its picture, other methods."""
    name, given = r.log, {j.figure for j in r.judgements}
    table, unknown = judged(f"Limits of {name}, the worst first.", [[j] for j in r.judgements])
    others = [
        (plain(key).name, plain(key).with_unit(value), key)
        for key, value in r.figures.items()
        if key not in given and value is not None
    ]
    rest = Table(("metric", "value", "key"), others, f"Metrics of {name} without a limit.")
    return Facts(
        f"{name}: {word(r)}",
        verdict=PASSED if r.passed else FAILED,
        tables=[table, *_beside(r)],
        notes=unknown,
        pictures=[pads_over_time(r)],
        parts=[Facts("Metrics that are not judged", tables=[rest], folded=True)],
    )
