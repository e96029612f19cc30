"""The report of a car: verdict on top, what to do, figures, limits, where it all comes from."""

from calib import __version__
from calib.plots.sheet import Sheet
from calib.plots.station import sheet
from calib.reports.html import figure, folded, listing, page, paragraph, section, table, terms
from calib.station.advice import action, reason
from calib.station.identity import TITLES
from calib.station.station import Check, StationOutcome
from calib.station.words import HEADINGS, bounds, in_full, summary, value_of
from calib.table.version import Stored
from calib.validation.limits import FAILED, NOT_KNOWN, PASSED, WARNING
from calib.validation.validate import Validation


def report_html(found: StationOutcome, stored: Stored) -> str:
    """Return the report as one HTML document, without a clock or a path in it."""
    drawn = sheet(found.table, found.results)
    parts = [
        _head(found, stored),
        _next(found),
        _limits(found),
        _pads(found, drawn),
        _curves(found, drawn),
        _stops(found, drawn),
        _provenance(found, stored),
    ]
    name = found.identity.vin or found.identity.serial or found.table.vehicle.name
    return page(f"{HEADINGS[found.verdict]}: {name}", parts)


def _head(found: StationOutcome, stored: Stored) -> str:
    given = [(TITLES[name], value) for name, value in found.identity.given().items()]
    rows = [("Vehicle", found.table.vehicle.name), *given, ("Table", stored.id)]
    return (
        f'<header class="{found.verdict}">\n<h1>Brake torque calibration of one car</h1>\n'
        f'<p class="verdict big kind">{HEADINGS[found.verdict]}</p>\n'
        f"{paragraph(summary(found))}\n{terms(rows)}\n</header>"
    )


def _next(found: StationOutcome) -> str:
    """One sentence for each check that fails or warns, and what can be done about it."""
    bad = found.with_verdict(FAILED) + found.with_verdict(WARNING)
    if not bad:
        return section("What to do next", paragraph("Nothing: every judged figure holds."))
    rows = [(check.verdict, in_full(check), action(check.figure)) for check in bad]
    return section(
        "What to do next",
        table(
            "What is not as it should be, and the next step.",
            ("verdict", "found", "next step"),
            rows,
            [check.verdict for check in bad],
            "steps",
        ),
    )


def _limits(found: StationOutcome) -> str:
    car = [check for check in found.checks if check.of_car]
    meant = {check.figure: check.meaning for check in found.checks}
    reasons = [(name, f"{meant[name]}: {reason(name)}.") for name in meant]
    return section(
        "Limits",
        _of_car(car) if car else "",
        _of_stops(found),
        folded(
            "The figures by name, and why their limits stand where they stand by default",
            terms(reasons),
        ),
    )


def _of_car(checks: list[Check]) -> str:
    rows = [
        (
            check.meaning,
            value_of(check),
            check.verdict,
            bounds(check.judgement.warn_low, check.judgement.warn_high),
            bounds(check.judgement.low, check.judgement.high),
        )
        for check in checks
    ]
    kinds = ["unjudged" if c.verdict == NOT_KNOWN else c.verdict for c in checks]
    heads = ("figure", "value", "verdict", "no warning", "limit")
    return table("The car as a whole.", heads, rows, kinds, "checks")


def _of_stops(found: StationOutcome) -> str:
    """One row a figure, one column a stop; what does not pass says so in its cell."""
    by_figure: dict[str, list[Check]] = {}
    for check in found.checks:
        if not check.of_car:
            by_figure.setdefault(check.figure, []).append(check)
    if not by_figure:
        return ""
    rows, kinds = [], []
    for checks in by_figure.values():
        j = checks[0].judgement
        ranges = bounds(j.warn_low, j.warn_high), bounds(j.low, j.high)
        rows.append((checks[0].meaning, *map(_cell, checks), *ranges))
        kinds.append(_worst(checks))
    stops = [f"stop {i}" for i in range(1, len(found.results) + 1)]
    names = "; ".join(f"{i}: {r.log}" for i, r in enumerate(found.results, 1))
    heads = ("figure", *stops, "no warning", "limit")
    return table(f"Each stop. {names}.", heads, rows, kinds, "stops")


def _cell(check: Check) -> str:
    value = value_of(check, 3)
    return value if check.verdict in (PASSED, NOT_KNOWN) else f"{value} {check.verdict}"


def _worst(checks: list[Check]) -> str:
    words = {check.verdict for check in checks}
    return next(word for word in (FAILED, WARNING, PASSED, NOT_KNOWN) if word in words)


def _pads(found: StationOutcome, drawn: Sheet) -> str:
    rows = [
        (f"{i}: {r.log}", *_value(r, "f"), *_value(r, "r")) for i, r in enumerate(found.results, 1)
    ]
    heads = ("stop", "front", "95 % interval", "rear", "95 % interval")
    cal = found.table.calibration
    of_table = [
        f"{v.value:.3f} ({v.ci95[0]:.3f} to {v.ci95[1]:.3f})"
        for v in (cal.pad_friction_f, cal.pad_friction_r)
    ]
    return section(
        "Pads",
        paragraph(f"The ramp found a pad friction of {of_table[0]} front, {of_table[1]} rear."),
        figure(
            drawn,
            (("pads",),),
            "Points with intervals: pad friction of both axles in each stop; the values stand in "
            "the table below.",
            "Pad friction of each stop with its 95 % interval; line and band are the table's.",
        ),
        table("Pad friction by stop.", heads, rows),
    )


def _value(result: Validation, axle: str) -> tuple[str, str]:
    mu, width = result.figures[f"pad_friction_{axle}"], result.figures[f"interval_{axle}"]
    if mu is None or width is None:
        return "not known", ""
    return f"{mu:.3f}", f"{mu - mu * width:.3f} to {mu + mu * width:.3f}"


def _curves(found: StationOutcome, drawn: Sheet) -> str:
    p = found.table.paper
    picked = sorted({round(i * (len(p.eta) - 1) / 15) for i in range(16)})
    rows = [
        (
            f"{100 * (p.eta[i] - 1):.3f} %",
            f"{p.z[i]:.3f}",
            f"{p.f1[i]:+.4f}",
            f"{0.5 * (p.f1_upper[i] - p.f1_lower[i]):.4f}",
            f"{p.f2[i]:+.4f}",
            f"{0.5 * (p.f2_upper[i] - p.f2_lower[i]):.4f}",
            f"{p.count[i]:.0f}",
        )
        for i in picked
    ]
    heads = ("eta - 1", "deceleration [g]", "f1", "+-", "f2", "+-", "blocks")
    return section(
        "The table",
        figure(
            drawn,
            (("f1-f2", "difference"),),
            "Two plots over eta - 1: f1 and f2, and their difference D, with 95 % bands. Every "
            "few rows stand in the table below.",
            "The curves that the estimator looks up, with their 95 % bands.",
        ),
        folded("Read it as a table", table("Every few rows of f1 and f2.", heads, rows)),
    )


def _stops(found: StationOutcome, drawn: Sheet) -> str:
    names = [f"stop-{i}" for i in range(1, len(found.results) + 1)]
    rows = [tuple(names[i : i + 2]) for i in range(0, len(names) - 1, 2)]
    if len(names) % 2:
        rows.append((names[-1],) * (2 if len(names) > 1 else 1))
    ends = [f"{r.log}: front {_value(r, 'f')[0]}, rear {_value(r, 'r')[0]}" for r in found.results]
    return section(
        "The stops",
        figure(
            drawn,
            tuple(rows),
            f"Pad friction over time in each stop. Means: {'; '.join(ends)}.",
            "Pad friction over time with its 95 % band; grey: the estimator does not stand behind "
            "the sample.",
        ),
        listing(
            [
                f"{r.log}: the surface changed at {time:.2f} s"
                for r in found.results
                for time in r.estimate.split.changes
            ]
        ),
    )


def _provenance(found: StationOutcome, stored: Stored) -> str:
    logs = [(log.name, "ramp", log.digest[:16]) for log in found.ramps]
    logs += [(log.name, "coast", log.digest[:16]) for log in found.coasts]
    logs += [(r.log, r.role, r.digest[:16]) for r in found.results]
    rows = [
        ("Table", f"{stored.id}, SHA-256 {stored.digest}"),
        ("Golden table", found.golden or "none given"),
        ("Program", f"brake-cal {__version__}"),
    ]
    settings = [(k, f"{v:g}") for k, v in found.table.provenance.settings.items()]
    return section(
        "Where it comes from",
        terms(rows),
        table(
            "Logs, by the first 16 digits of the SHA-256 of their bytes.",
            ("log", "role", "SHA-256"),
            logs,
        ),
        folded("Settings of the fit", table("Settings, in SI.", ("setting", "value"), settings)),
        "<h3>Remarks</h3>" if found.table.remarks or found.caveats else "",
        listing([*found.table.remarks, *(f"{name}: {text}" for name, text in found.caveats)]),
    )
