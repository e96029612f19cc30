"""Facts of a car at the station: verdict, next steps, metrics and limits, curves, origin."""

from dataclasses import replace

import numpy as np

from calib.base.names import AXLE_NAMES
from calib.base.plain import plain, plus_minus
from calib.estimation.limits import FAILED, WARNING, Judgement
from calib.estimation.validate import Validation
from calib.line.station.limits_file import action
from calib.line.station.station import TITLES, StationOutcome
from calib.show.facts import WORDS, Facts, Picture
from calib.show.facts import Table as Cells
from calib.show.judged import judged, pads
from calib.show.origin import PageOrigin, origin
from calib.show.sheet import Panel, Sheet
from calib.show.stop import pads_over_time
from calib.show.style import FRONT, REAR, Axes
from calib.show.table import sheet as table_sheet
from calib.show.validation import on_the_way
from calib.store.version import Stored
from calib.table.budget import advice_lines, pads_budget
from calib.table.table import Table

_TAKEN = ("f1-f2", "difference", "budget")
"""Panels of the table's own sheet."""
CURVES = "The curves that the estimator looks up, with their 95 % bands."
BY_STOP = "Pad friction of each stop with its 95 % interval; line and band: the table's."
_OVER_TIME = "Pad friction over time with its 95 % band; grey: not valid."


def facts(found: StationOutcome, stored: Stored, date: str = "") -> Facts:
    """The verdict on a car, the worst metrics first, without a path.

    ``date`` is the one that was stated for the run, "" for none: a clock would change the bytes.
    """
    table, identity = found.table, found.identity
    name = identity.vin or identity.serial or table.vehicle.name
    mean = f", mean of {found.golden_cars} cars" if found.golden_cars else ""
    of_stops: dict[str, list[Judgement]] = {}
    for check in found.checks:
        if not check.of_car:
            of_stops.setdefault(check.figure, []).append(check.judgement)
    stops = ", ".join(r.log for r in found.results)
    of_car = [[check.judgement] for check in found.checks if check.of_car]
    car, unknown = judged("The car as a whole, the worst first.", of_car)
    by_stop, unknown_too = judged(f"Stop by stop, in this order: {stops}.", [*of_stops.values()])
    bad = found.with_verdict(FAILED) + found.with_verdict(WARNING)
    steps = [(check.verdict, check.text, action(check.figure)) for check in bad]
    heads = ("verdict", "result", "next step")
    return Facts(
        title=f"Brake torque calibration of {name}",
        headline=f"{stored.id}, {stored.state.why}: {found.headline}.",
        verdict=found.verdict,
        word=WORDS[found.verdict],
        rows=[
            ("Vehicle", table.vehicle.name),
            *((TITLES[name], value) for name, value in identity.given().items()),
            ("Mass", str(found.results[0].mass)),
            ("Date", date or "not stated (--date)"),
            ("Operator", found.by or "not stated (--by)"),
            ("Limits file", found.limits or "none: those of the program"),
            ("Golden table", f"{found.golden}{mean}" if found.golden else "none given"),
        ],
        tables=[
            Cells(heads, steps, "Limits that are not held.", [step[0] for step in steps]),
            car,
            by_stop,
        ],
        notes=[*unknown, *unknown_too],
        warnings=found.warnings,
    )


def report(found: StationOutcome, stored: Stored, date: str = "") -> Facts:
    """The facts with pads, curves, stops and origin; equal inputs give equal facts."""
    pictures = sheet(found.table, found.results)
    stops = [f"stop-{i}" for i, _ in enumerate(found.results, 1)]
    notes = [f"{r.log}: {text}" for r in found.results for text in on_the_way(r)]
    meant = {check.figure: check.meaning for check in found.checks}
    meanings = [
        (plain(key).name, f"{key}: {text}. Why: {plain(key).reason or 'no limit by default'}.")
        for key, text in meant.items()
    ]
    curves = [Picture(CURVES, pictures, ("f1-f2", "difference"))]
    over_time = [Picture(_OVER_TIME, pictures, stops)]
    logs = [("ramp", log.name, log.digest) for log in found.ramps]
    logs += [("coast", log.name, log.digest) for log in found.coasts]
    logs += [(r.role, r.log, r.digest) for r in found.results]
    remarks = [*found.table.remarks, *map(str, found.caveats)]
    told = facts(found, stored, date)
    parts = [
        Facts("What each metric is, and why its limit", rows=meanings, folded=True),
        _pads(found, pictures),
        Facts("The table", pictures=curves),
        Facts("The stops", pictures=over_time, notes=notes),
        Facts("Remarks", notes=remarks, folded=True),
        origin(PageOrigin(date), stored, logs, str(found.results[0].mass)),
    ]
    return replace(told, parts=parts)


def _pads(found: StationOutcome, pictures: Sheet) -> Facts:
    """Pad friction from the ramp and by stop, and what its interval is made of."""
    cal, budgets = found.table.calibration, pads_budget(found.table)
    of_ramp = [
        plus_minus(pad.value, pad.ci95[1] - pad.value)
        for pad in (cal.pad_friction_f, cal.pad_friction_r)
    ]
    rows = [("the ramp", *of_ramp)]
    rows += [
        (f"{i}: {r.log}", *(pads(r.figures, axle) or "not known" for axle in "fr"))
        for i, r in enumerate(found.results, 1)
    ]
    parts = "; ".join(f"{AXLE_NAMES[x]} {of.words}" for x, of in zip("fr", budgets, strict=True))
    return Facts(
        "Pads",
        tables=[Cells(("run", "front", "rear"), rows, "Pad friction, with 95 % intervals.")],
        notes=advice_lines(budgets),
        pictures=[
            Picture(BY_STOP, pictures, ("pads",)),
            Picture(f"The interval of the ramp's pads is made of: {parts}.", pictures, ("budget",)),
        ],
    )


def sheet(table: Table, results: tuple[Validation, ...]) -> Sheet:
    """Panels of the table, `pads`, and `stop-1`, `stop-2` ... for the hold-outs."""
    curves = [panel for panel in table_sheet(table, "").panels if panel.name in _TAKEN]
    by_stop = Panel("pads", "Pads by stop", _pads_by_stop, (table, results), 2)
    stops = [
        Panel(f"stop-{i}", _as_text(r.log), pads_over_time, (r,), 2)
        for i, r in enumerate(results, 1)
    ]
    return Sheet("station", "station", "", "", (*curves, by_stop, *stops), ())


def _pads_by_stop(ax: Axes, table: Table, results: tuple[Validation, ...]) -> None:
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
