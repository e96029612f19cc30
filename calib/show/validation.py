"""The report of a validation: the verdict, what limits it, and a section for each stop."""

from collections.abc import Sequence
from dataclasses import replace

from calib.base.plain import plain, plus_minus, signed_percent
from calib.estimation import words
from calib.estimation.validate import (
    CALIBRATION,
    NO_HOLDOUT,
    Validation,
    all_warnings,
)
from calib.show.html import Report, drawn
from calib.show.judged import judged_rows, row, sorted_rows, warned
from calib.show.origin import PageOrigin, where_from
from calib.show.sheet import Panel, Sheet
from calib.show.stop import pads_over_time
from calib.show.stop import sheet as stop_sheet
from calib.show.trace import StopTrace
from calib.store.version import Stored
from calib.table.budget import advice_lines
from calib.table.table import Table

BY_STOP = "Stop by stop: pads with 95 % intervals, their change since the ramp, and the verdict."
PANELS = ("deceleration", "axle-torques")
"""Panels of a stop that are shown beside its pads, where the stop has them."""


def report_html(
    stored: Stored, results: Sequence[Validation], traces: Sequence[StopTrace], origin: PageOrigin
) -> str:
    """Return the report as one HTML document, ``traces`` of the same stops.

    Equal inputs give equal bytes but for the date of ``origin``.
    """
    table, found = stored.table, list(results)
    warnings = all_warnings(table.warnings, found)
    truth = any(result.figures["torque_error_f"] is not None for result in found)
    failed = not all(result.passed for result in found)
    page = Report(
        f"Validation of {stored.id}",
        f"Validation of {stored.id}",
        "failed" if failed else "warning" if warnings else "passed",
        "Failed" if failed else "Passed with warnings" if warnings else "Passed",
    )
    page.text(_sentence(words.outcome(stored, found)))
    page.terms(
        {
            "Table": f"{stored.id}, {stored.state.why}",
            "SHA-256": stored.digest,
            "Vehicle": table.vehicle.name,
            "Mass": str(found[0].mass),
            "Date": origin.date,
        }
    )
    page.section("What limits it")
    page.terms(_limits(found))
    page.listing(advice_lines(of for result in found for of in result.limiting or ()))
    page.warnings(map(warned, warnings))
    page.section("Key figures")
    heads = ("stop", *HEADS, *(TRUTH if truth else ()), "verdict")
    rows = [_figures(result, table, truth) for result in found]
    page.table(BY_STOP, heads, rows, "checks", [_kind(result) for result in found])
    for i, pair in enumerate(zip(found, traces, strict=True), 1):
        _stop(page, i, *pair)
    logs = [(r.role, r.log, r.digest) for r in found]
    where_from(page, origin, table, logs, str(found[0].mass))
    return page.html()


def _sentence(text: str) -> str:
    """Words of the program as a sentence of the page."""
    return f"{text[0].upper()}{text[1:]}.".replace("`", "")


def _limits(found: list[Validation]) -> list[tuple[str, str]]:
    """What limits the result: broken limits, samples that are not valid, parts of the interval."""
    rows = []
    for result in found:
        if result.role == CALIBRATION:
            rows.append((result.log, NO_HOLDOUT))
        rows += [(result.log, text) for text in words.broken(result)]
        for why, share in result.refused.items():
            rows.append((result.log, f"{100 * share:.0f} % of the braked samples: {why}"))
        for axle, of in zip(("front", "rear"), result.budget or (), strict=False):
            rows.append((f"{result.log}, {axle} pads", of.words))
    return rows + words.on_roads(found)


def _kind(result: Validation) -> str:
    return "passed" if result.passed else "failed"


HEADS = ("front pads", "since the ramp", "rear pads", "since the ramp", "valid samples")
TRUTH = ("torque error, front", "torque error, rear")


def _figures(result: Validation, table: Table, truth: bool) -> tuple[str, ...]:
    """Pads with intervals and their change since the ramp, valid samples, errors, verdict."""
    f, cal = result.figures, table.calibration
    cells = []
    for axle, ramp in (("f", cal.pad_friction_f), ("r", cal.pad_friction_r)):
        mu = f[f"pad_friction_{axle}"]
        cells.append(_pads(mu, f[f"interval_{axle}"]))
        cells.append("" if mu is None else signed_percent(mu / ramp.value - 1.0))
    names = ("valid_share", *(("torque_error_f", "torque_error_r") if truth else ()))
    cells += [plain(name).with_unit(f[name]) for name in names]
    return result.log, *cells, words.word(result)


def _pads(mu: float | None, width: float | None) -> str:
    if mu is None or width is None:
        return "not known"
    return plus_minus(mu, mu * width)


def _stop(page: Report, number: int, result: Validation, trace: StopTrace) -> None:
    """The section of one stop: judged metrics, the others, its picture, what is to be said."""
    rows = sorted_rows([row([j]) for j in result.judgements])
    given, name = {j.figure for j in result.judgements}, result.log
    page.section(f"{name}: {words.word(result)}", kind=_kind(result))
    for sentence in [] if result.role == CALIBRATION else words.sentences(result):
        page.text(_sentence(sentence))
    judged_rows(page, f"Limits of {name}, the worst first.", rows)
    panels = _sheet(number, result, trace)
    caption = f"{name}: pad friction with its 95 % band, deceleration, torques; grey: not valid."
    page.figure(drawn(panels, *panels.names), caption)
    changes = [f"the surface changed at {t:.2f} s" for t in result.estimate.split.changes]
    page.listing([*result.estimate.notes, *changes])
    others = [
        (plain(key).name, plain(key).with_unit(value), key)
        for key, value in result.figures.items()
        if key not in given and value is not None
    ]
    with page.inside("fold", "Metrics that are not judged"):
        page.table(f"Metrics of {name} without a limit.", ("metric", "value", "key"), others)


def _sheet(number: int, result: Validation, trace: StopTrace) -> Sheet:
    """Pads over time, and the panels of the stop; names are unique in the page."""
    pads = Panel(f"pads-{number}", "Pad friction", pads_over_time, (result,), 2)
    taken = [p for p in stop_sheet(trace).panels if p.name in PANELS]
    panels = (pads, *(replace(p, name=f"{p.name}-{number}") for p in taken))
    return Sheet("stop", result.log, "", "", panels, tuple((p.name,) for p in panels))
