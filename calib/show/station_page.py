"""The report of a car: verdict, next steps, metrics and limits, curves, origin of the data."""

import numpy as np

from calib.base.names import AXLE_NAMES
from calib.base.plain import plain
from calib.base.program import PROGRAM
from calib.estimation.limits import FAILED, WARNING, Judgement
from calib.estimation.validate import Validation
from calib.line.station.advice import action, reason
from calib.line.station.identity import TITLES
from calib.line.station.metrics import CUT
from calib.line.station.station import StationOutcome
from calib.line.station.words import HEADINGS, in_full, summary
from calib.show.html import Report, drawn
from calib.show.judged import judged_rows, row, sorted_rows, warned
from calib.show.origin import settings_of
from calib.show.sheet import Panel, Sheet
from calib.show.stop import pads_over_time
from calib.show.style import FRONT, REAR, Axes
from calib.show.table import sheet as table_sheet
from calib.show.validation import on_the_way
from calib.store.version import Stored
from calib.table.budget import advice_lines
from calib.table.pads_budget import pads_budget
from calib.table.table import Table

TAKEN = ("f1-f2", "difference", "budget")
"""Panels of the table's own sheet."""
CURVE_HEADS = ("eta - 1", "deceleration [g]", "f1", "+-", "f2", "+-", "blocks")


def report_html(found: StationOutcome, stored: Stored, date: str = "") -> str:
    """Return the report as one HTML document, without a path in it.

    ``date`` is the one that was stated for the run, "" for none: a clock would change the bytes.
    """
    table, results, identity = found.table, found.results, found.identity
    given = [(TITLES[name], value) for name, value in identity.given().items()]
    bad = found.with_verdict(FAILED) + found.with_verdict(WARNING)
    page = Report(
        f"{HEADINGS[found.verdict]}: {identity.vin or identity.serial or table.vehicle.name}",
        "Brake torque calibration of one car",
        found.verdict,
        HEADINGS[found.verdict],
        body="one-page",
    )
    page.text(summary(found))
    page.terms(
        [
            ("Vehicle", table.vehicle.name),
            *given,
            ("Table", f"{stored.id}, {stored.state.why}"),
            ("Date", date or "not stated (--date)"),
            ("Operator", found.by or "not stated (--by)"),
            ("Limits file", found.limits or "none: those of the program"),
        ]
    )
    page.section("What to do next")
    steps = [(check.verdict, in_full(check), action(check.figure)) for check in bad]
    heads = ("verdict", "result", "next step")
    page.table("Limits that are not held.", heads, steps, "steps", [step[0] for step in steps])
    if not steps:
        held = "every judged metric is within its limit."
        page.text("Look at the warnings:" if found.warnings else "Nothing:", held)
    page.warnings(map(warned, found.warnings))
    page.section("Limits")
    _limits(page, found)
    page.section("Pads")
    _pads(page, found)
    page.section("The table", of="on-screen")
    curves = "The curves that the estimator looks up, with their 95 % bands."
    pictures = sheet(table, results)
    page.figure(drawn(pictures, "f1-f2", "difference"), curves)
    with page.inside("fold", "Read it as a table"):
        page.table("Every few rows of f1 and f2.", CURVE_HEADS, _curve_rows(table))
    page.section("The stops", of="on-screen")
    over_time = drawn(pictures, *(f"stop-{i}" for i in range(1, len(results) + 1)))
    page.figure(over_time, "Pad friction over time with its 95 % band; grey: not valid.")
    page.listing(f"{r.log}: {words}" for r in results for words in on_the_way(r))
    page.section("Where it comes from")
    origin = f"{stored.id}, SHA-256 {stored.digest}"
    page.terms({"Table": origin, "Golden table": _golden(found), "Program": PROGRAM})
    sources = [(log.name, "ramp", log.digest[:16]) for log in found.ramps]
    sources += [(log.name, "coast", log.digest[:16]) for log in found.coasts]
    sources += [(r.log, r.role, r.digest[:16]) for r in results]
    digests = "Logs, by the first 16 digits of the SHA-256 of their bytes."
    page.table(digests, ("log", "role", "SHA-256"), sources, "plain stack")
    with page.inside("on_screen"):
        settings_of(page, table)
        with page.inside("fold", "Remarks"):
            page.listing([*table.remarks, *map(str, found.caveats)])
    return page.html()


def _limits(page: Report, found: StationOutcome) -> None:
    """The judged metrics of the car and of its stops, the worst first."""
    by_figure: dict[str, list[Judgement]] = {}
    for check in found.checks:
        if not check.of_car:
            by_figure.setdefault(check.figure, []).append(check.judgement)
    of_car = [row([c.judgement], CUT.get(c.figure)) for c in found.checks if c.of_car]
    of_stops = [row(judgements) for judgements in by_figure.values()]
    judged_rows(page, "The car as a whole, the worst first.", sorted_rows(of_car))
    stops = ", ".join(r.log for r in found.results)
    judged_rows(page, f"Stop by stop, in this order: {stops}.", sorted_rows(of_stops))
    page.add("small", "The bar: darker within the limits, then a warning, at the ends failed.")
    meant = {check.figure: check.meaning for check in found.checks}
    with page.inside("on_screen"), page.inside("fold", "What each metric is, and why its limit"):
        page.terms(
            (plain(name).name, f"{name}: {meaning}. Why: {reason(name)}.")
            for name, meaning in meant.items()
        )


def _pads(page: Report, found: StationOutcome) -> None:
    """Pad friction from the ramp and by stop, and what its interval is made of."""
    cal, budgets = found.table.calibration, pads_budget(found.table)
    front, rear = (
        f"{pad.value:.3f} ({pad.ci95[0]:.3f} to {pad.ci95[1]:.3f})"
        for pad in (cal.pad_friction_f, cal.pad_friction_r)
    )
    page.text(f"Pad friction from the ramp: {front} front, {rear} rear.")
    rows = [(f"{i}: {r.log}", *_pad(r, "f"), *_pad(r, "r")) for i, r in enumerate(found.results, 1)]
    heads = ("stop", "front", "95 % interval", "rear", "95 % interval")
    page.table("Pad friction by stop.", heads, rows)
    parts = "; ".join(f"{AXLE_NAMES[x]} {of.words}" for x, of in zip("fr", budgets, strict=True))
    pictures = sheet(found.table, found.results)
    with page.inside("on_screen"):
        caption = "Pad friction of each stop with its 95 % interval; line and band: the table's."
        page.figure(drawn(pictures, "pads"), caption)
        advice = "; ".join(advice_lines(budgets)).capitalize()
        made_of = f"What the interval of the ramp's pads is made of: {parts}. {advice}."
        page.figure(drawn(pictures, "budget"), made_of)


def _golden(found: StationOutcome) -> str:
    mean = f", mean of {found.golden_cars} cars" if found.golden_cars else ""
    return f"{found.golden}{mean}" if found.golden else "none given"


def _pad(result: Validation, axle: str) -> tuple[str, str]:
    """Mean pad friction of a stop on ``axle`` f or r, and its 95 % interval."""
    mu, width = result.figures[f"pad_friction_{axle}"], result.figures[f"interval_{axle}"]
    if mu is None or width is None:
        return "not known", ""
    return f"{mu:.3f}", f"{mu - mu * width:.3f} to {mu + mu * width:.3f}"


def _curve_rows(table: Table) -> list[tuple[str, ...]]:
    """Rows of f1 and f2 for the page: at most 16, both ends among them."""
    p = table.paper
    return [
        (
            f"{100 * (p.eta[i] - 1):.3f} %",
            f"{p.z[i]:.3f}",
            f"{p.f1[i]:+.4f}",
            f"{0.5 * (p.f1_upper[i] - p.f1_lower[i]):.4f}",
            f"{p.f2[i]:+.4f}",
            f"{0.5 * (p.f2_upper[i] - p.f2_lower[i]):.4f}",
            f"{p.count[i]:.0f}",
        )
        for i in sorted({round(i * (len(p.eta) - 1) / 15) for i in range(16)})
    ]


def sheet(table: Table, results: tuple[Validation, ...]) -> Sheet:
    """Panels of the table, `pads`, and `stop-1`, `stop-2` ... for the hold-outs."""
    of_table = table_sheet(table, "").panels
    curves = tuple(panel for panel in of_table if panel.name in TAKEN)
    pads = Panel("pads", "Pads by stop", pads_by_stop, (table, results), 2)
    stops = tuple(
        Panel(f"stop-{i}", _as_text(r.log), pads_over_time, (r,), 2)
        for i, r in enumerate(results, 1)
    )
    panels = (*curves, pads, *stops)
    return Sheet("station", "station", "", "", panels, tuple((p.name,) for p in panels))


def pads_by_stop(ax: Axes, table: Table, results: tuple[Validation, ...]) -> None:
    """Mean pad friction of each hold-out with its median 95 % interval, and the table's."""
    cal = table.calibration
    for axle, stroke, of_table, shift in (
        ("f", FRONT, cal.pad_friction_f, -0.08),
        ("r", REAR, cal.pad_friction_r, 0.08),
    ):
        word = AXLE_NAMES[axle]
        low, high = of_table.ci95
        ax.axhspan(low, high, color=stroke["color"], alpha=0.18, lw=0.0)
        ax.axhline(of_table.value, **stroke, linewidth=0.9, label=f"{word}, table")
        known = [
            (i + shift, mu, mu * width)
            for i, r in enumerate(results, 1)
            if (mu := r.figures[f"pad_friction_{axle}"]) is not None
            and (width := r.figures[f"interval_{axle}"]) is not None
        ]
        if known:
            x, y, half = np.asarray(known).T
            marker = "o" if axle == "f" else "s"
            ax.errorbar(x, y, half, fmt=marker, color=stroke["color"], ms=4, label=f"{word}, stop")
    ax.set_xlim(0.5, len(results) + 0.5)
    ax.set_xticks(range(1, len(results) + 1))
    ax.set(xlabel="stop, in the order of the table below", ylabel="pad friction [1]")


def _as_text(name: str) -> str:
    """A log's name as plain text: no formula, and only characters that the font has."""
    return "".join(c if c.isascii() and c.isprintable() else "?" for c in name).replace("$", r"\$")
