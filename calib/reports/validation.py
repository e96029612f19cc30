"""The report of a validation: the verdict, what limits it, and a section for each stop."""

from collections.abc import Sequence

from calib.messages.plain import plain, plus_minus, signed_percent
from calib.plots.sheet import Panel, Sheet
from calib.plots.station import pads_over_time
from calib.plots.stop import sheet as stop_sheet
from calib.plots.trace import StopTrace
from calib.reports.html import drawn, page
from calib.reports.judged import row, sorted_rows, warned
from calib.reports.origin import PageOrigin, origin_view
from calib.store.version import Stored
from calib.table.budget import advice_lines
from calib.table.table import Table
from calib.validation import words
from calib.validation.limits import NOT_KNOWN
from calib.validation.validate import (
    CALIBRATION,
    NO_HOLDOUT,
    Validation,
    all_warnings,
)

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
    return page(
        "validation",
        title=f"Validation of {stored.id}",
        name=stored.id,
        kind="failed" if failed else "warning" if warnings else "passed",
        heading="Failed" if failed else "Passed with warnings" if warnings else "Passed",
        headline=_sentence(words.outcome(stored, found)),
        identity=[
            ("Table", f"{stored.id}, {stored.state.why}"),
            ("SHA-256", stored.digest),
            ("Vehicle", table.vehicle.name),
            ("Mass", str(found[0].mass)),
            ("Date", origin.date),
        ],
        limits=_limits(found),
        advice=advice_lines(of for result in found for of in result.limiting or ()),
        warnings=[warned(warning) for warning in warnings],
        figure_heads=["stop", *HEADS, *(TRUTH if truth else ()), "verdict"],
        figures=[_figures(result, table, truth) for result in found],
        figure_kinds=[_kind(result) for result in found],
        stops=[_stop(i, *pair) for i, pair in enumerate(zip(found, traces, strict=True), 1)],
        settings=[(name, f"{value:g}") for name, value in table.provenance.settings.items()],
        **origin_view(
            origin,
            table.vehicle,
            [(r.role, r.log, r.digest) for r in found],
            str(found[0].mass),
        ),
    )


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


def _stop(number: int, result: Validation, trace: StopTrace) -> dict[str, object]:
    """One stop: judged metrics, the others, its picture, and what is to be said."""
    rows = sorted_rows([row([j]) for j in result.judgements])
    judged, f = {j.figure for j in result.judgements}, result.figures
    panels = _sheet(number, result, trace)
    notes = list(result.estimate.notes)
    notes += [f"the surface changed at {t:.2f} s" for t in result.estimate.split.changes]
    return {
        "name": result.log,
        "kind": _kind(result),
        "word": words.word(result),
        "said": [] if result.role == CALIBRATION else map(_sentence, words.sentences(result)),
        "judged": [one for one in rows if one.verdict != NOT_KNOWN],
        "unknown": [one.name for one in rows if one.verdict == NOT_KNOWN],
        "others": [
            (plain(name).name, plain(name).with_unit(value), name)
            for name, value in result.figures.items()
            if name not in judged and value is not None
        ],
        "picture": drawn(panels, *panels.names),
        "alt": f"Pads over time, deceleration and torques of {result.log}. Mean pad friction: "
        + ", ".join(_pads(f[f"pad_friction_{x}"], f[f"interval_{x}"]) for x in "fr"),
        "notes": notes,
    }


def _sheet(number: int, result: Validation, trace: StopTrace) -> Sheet:
    """Pads over time, and the panels of the stop; names are unique in the page."""
    pads = Panel(f"pads-{number}", "Pad friction", lambda ax: pads_over_time(ax, result), 2)
    others = [
        Panel(f"{p.name}-{number}", p.title, p.draw, p.columns)
        for p in stop_sheet(trace).panels
        if p.name in PANELS
    ]
    panels = (pads, *others)
    return Sheet("stop", result.log, "", "", panels, tuple((p.name,) for p in panels))
