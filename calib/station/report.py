"""The report of a car: verdict, next steps, metrics and limits, curves, origin of the data."""

from calib.messages.plain import plain
from calib.plots.station import sheet
from calib.program import PROGRAM
from calib.reports.html import drawn, page
from calib.reports.judged import JudgedRow, row, sorted_rows, warned
from calib.station.advice import action, reason
from calib.station.identity import TITLES
from calib.station.metrics import CUT
from calib.station.station import StationCheck, StationOutcome
from calib.station.words import HEADINGS, in_full, summary
from calib.store.version import Stored
from calib.table.budget import advice_lines
from calib.table.pads_budget import pads_budget
from calib.table.table import Table
from calib.validation.limits import FAILED, NOT_KNOWN, WARNING
from calib.validation.validate import Validation
from calib.validation.words import on_the_way


def report_html(found: StationOutcome, stored: Stored, date: str = "") -> str:
    """Return the report as one HTML document, without a path in it.

    ``date`` is the one that was stated for the run, "" for none: a clock would change the bytes.
    """
    table, results, identity = found.table, found.results, found.identity
    given = [(TITLES[name], value) for name, value in identity.given().items()]
    bad = found.with_verdict(FAILED) + found.with_verdict(WARNING)
    of_car, of_stops, unjudged = _rows(found)
    meant = {check.figure: check.meaning for check in found.checks}
    pads = (table.calibration.pad_friction_f, table.calibration.pad_friction_r)
    sources = [(log.name, "ramp", log.digest) for log in found.ramps]
    sources += [(log.name, "coast", log.digest) for log in found.coasts]
    sources += [(r.log, r.role, r.digest) for r in results]
    pictures = sheet(table, results)
    budgets = pads_budget(table)
    return page(
        "station",
        title=f"{HEADINGS[found.verdict]}: {identity.vin or identity.serial or table.vehicle.name}",
        verdict=found.verdict,
        heading=HEADINGS[found.verdict],
        summary=summary(found),
        identity=[
            ("Vehicle", table.vehicle.name),
            *given,
            ("Table", f"{stored.id}, {stored.state.why}"),
            ("Date", date or "not stated (--date)"),
            ("Operator", found.by or "not stated (--by)"),
            ("Limits file", found.limits or "none: those of the program"),
        ],
        next_steps=[(check.verdict, in_full(check), action(check.figure)) for check in bad],
        warnings=[warned(warning) for warning in found.warnings],
        of_car=of_car,
        of_stops=of_stops,
        unjudged=unjudged,
        reasons=[
            (plain(name).name, f"{name}: {text}. Why: {reason(name)}.")
            for name, text in meant.items()
        ],
        ramp_pads=[f"{v.value:.3f} ({v.ci95[0]:.3f} to {v.ci95[1]:.3f})" for v in pads],
        pads=drawn(pictures, "pads"),
        budget=drawn(pictures, "budget"),
        budget_words=[
            f"{axle} {of.words}" for axle, of in zip(("front", "rear"), budgets, strict=True)
        ],
        budget_advice=advice_lines(budgets),
        stops=[r.log for r in results],
        pad_rows=[
            (f"{i}: {r.log}", *_pad(r, "f"), *_pad(r, "r")) for i, r in enumerate(results, 1)
        ],
        curves=drawn(pictures, "f1-f2", "difference"),
        curve_rows=_curve_rows(table),
        over_time=drawn(pictures, *(f"stop-{i}" for i in range(1, len(results) + 1))),
        means=[f"{r.log}: front {_pad(r, 'f')[0]}, rear {_pad(r, 'r')[0]}" for r in results],
        on_the_way=[f"{r.log}: {text}" for r in results for text in on_the_way(r)],
        provenance=[
            ("Table", f"{stored.id}, SHA-256 {stored.digest}"),
            ("Golden table", _golden(found)),
            ("Program", PROGRAM),
        ],
        logs=[(name, role, digest[:16]) for name, role, digest in sources],
        settings=[(name, f"{value:g}") for name, value in table.provenance.settings.items()],
        remarks=[*table.remarks, *map(str, found.caveats)],
    )


def _golden(found: StationOutcome) -> str:
    mean = f", mean of {found.golden_cars} cars" if found.golden_cars else ""
    return f"{found.golden}{mean}" if found.golden else "none given"


def _rows(found: StationOutcome) -> tuple[list[JudgedRow], list[JudgedRow], list[str]]:
    """Rows of the car, rows of the stops, and plain names of what is not known."""
    of_car = [row([c.judgement], CUT.get(c.figure)) for c in found.checks if c.of_car]
    of_stops = [
        row([c.judgement for c in checks])
        for checks in _by_figure([c for c in found.checks if not c.of_car])
    ]
    unjudged = [r.name for r in (*of_car, *of_stops) if r.verdict == NOT_KNOWN]
    return _known(of_car), _known(of_stops), unjudged


def _known(rows: list[JudgedRow]) -> list[JudgedRow]:
    return sorted_rows([r for r in rows if r.verdict != NOT_KNOWN])


def _by_figure(checks: list[StationCheck]) -> list[list[StationCheck]]:
    """The checks of all stops, grouped by metric."""
    groups: dict[str, list[StationCheck]] = {}
    for check in checks:
        groups.setdefault(check.figure, []).append(check)
    return list(groups.values())


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
