"""The report of a fit: may the table be used, what limits it, its curves, its inputs."""

from collections.abc import Sequence

from calib.base.plain import counted, plus_minus
from calib.car.mass import MassUsed
from calib.logs.log import Log
from calib.show.html import Report, drawn
from calib.show.judged import warned
from calib.show.origin import PageOrigin, where_from
from calib.show.ramp import measure
from calib.show.table import sheet
from calib.store.answer import answer, verdict
from calib.store.figures import effect_figures
from calib.store.version import Stored
from calib.table.budget import advice_lines, pads_budget
from calib.table.table import Value

MADE_OF = "What the interval of the pads is made of, as standard deviations; their squares add up."
CURVES = "The curves that the estimator looks up, with their 95 % bands"


def report_html(stored: Stored, ramps: Sequence[Log], mass: MassUsed, origin: PageOrigin) -> str:
    """Return the report as one HTML document; ``ramps`` are the logs with braking of the fit.

    Equal inputs give equal bytes but for the date of ``origin``.
    """
    table, found = stored.table, answer(stored)
    cal = table.calibration
    budgets = pads_budget(table)
    panels = sheet(table, stored.id, tuple(measure(table, log) for log in ramps))
    of_ramps = [n for n in panels.names if n.startswith(("ramp", "pressure", "forces"))]
    count = len(table.warnings)
    page = Report(
        f"Table {stored.id}",
        f"Table {stored.id}",
        "warning" if count else "passed",
        f"Fitted, with {counted(count, 'warning')}" if count else "Fitted",
    )
    page.text(f"{stored.id} is {verdict(stored)}.")
    key_numbers = {
        "front pads": _pads(cal.pad_friction_f),
        "rear pads": _pads(cal.pad_friction_r),
        "of the vehicle file's": f"{100.0 * cal.pad_scale.value:.1f} %",
        "usable up to": f"{found.decelerations[1]:.2f} g",
    }
    page.add("key_numbers", list(key_numbers.items()))
    page.section("What limits it")
    page.terms(
        {
            "State": stored.state.words,
            "Range": found.limit,
            "Front pads": budgets[0].words,
            "Rear pads": budgets[1].words,
            "Next": found.next.replace("`", ""),
        }
    )
    page.listing(advice_lines(budgets))
    page.figure(drawn(panels, "budget"), MADE_OF)
    page.warnings(map(warned, table.warnings))
    page.section("Key figures")
    heads = ("figure", "value", "95 % interval", "unit")
    page.table("What was estimated, with 95 % intervals.", heads, _figures(stored))
    page.section("The curves")
    page.figure(drawn(panels, "f1-f2", "difference"), f"{CURVES}, and the measured points.")
    tyre = drawn(panels, "tyre", "torque-distribution")
    page.figure(tyre, "The tyre curve, and the brake torques front against rear.")
    if of_ramps:
        page.figure(drawn(panels, *of_ramps), "The ramps of the fit.")
    page.section("Remarks")
    page.listing(table.remarks)
    logs = [(log.role, log.name, log.digest) for log in table.provenance.logs]
    where_from(page, origin, table, logs, str(mass))
    return page.html()


def _pads(value: Value) -> str:
    return plus_minus(value.value, value.ci95[1] - value.value)


def _figures(stored: Stored) -> list[tuple[str, ...]]:
    """Name, value, 95 % interval and unit of everything that was estimated."""
    cal, q = stored.table.calibration, stored.table.quality
    rows = [
        _row(name, value.value, value.ci95, "1")
        for name, value in (
            ("Pad friction, front", cal.pad_friction_f),
            ("Pad friction, rear", cal.pad_friction_r),
            ("Pad friction as a share of the vehicle file's", cal.pad_scale),
        )
    ]
    rows += [
        _row(f"{of.effect}: {of.name}".replace("_", " "), of.value.value, of.ci95, of.unit)
        for of in effect_figures(stored.table)
    ]
    eta, peak = 100.0 * (q["eta_peak"] - 1.0), q["eta_peak_deceleration"]
    return [
        *rows,
        ("Deceleration that the ramp reached", f"{q['deceleration_max']:.2f}", "", "g"),
        ("Largest eta - 1", f"{eta:.2f}", "", "%"),
        ("Deceleration at the largest eta", f"{peak:.2f}", "", "g"),
        ("Front axle locks first up to", f"{q['front_biased_up_to']:.2f}", "", "g"),
    ]


def _row(name: str, value: float, ci95: tuple[float, float], unit: str) -> tuple[str, ...]:
    low, high = ci95
    return name, f"{value:.4g}", f"{low:.4g} to {high:.4g}", unit
