"""The report of a fit: may the table be used, what limits it, its curves, its inputs."""

from collections.abc import Sequence

from calib.logs.log import Log
from calib.messages.plain import plus_minus
from calib.physics.mass import MassUsed
from calib.plots.measured import measure
from calib.plots.table import sheet
from calib.reports.html import drawn, page
from calib.reports.judged import warned
from calib.reports.origin import PageOrigin, origin_view
from calib.store.answer import answer, verdict
from calib.store.version import Stored
from calib.table.budget import advice_lines
from calib.table.effect_figures import effect_figures
from calib.table.pads_budget import pads_budget
from calib.table.table import Value


def report_html(stored: Stored, ramps: Sequence[Log], mass: MassUsed, origin: PageOrigin) -> str:
    """Return the report as one HTML document; ``ramps`` are the logs with braking of the fit.

    Equal inputs give equal bytes but for the date of ``origin``.
    """
    table, found = stored.table, answer(stored)
    cal = table.calibration
    budgets = pads_budget(table)
    panels = sheet(table, stored.id, tuple(measure(table, log) for log in ramps))
    of_ramps = [n for n in panels.names if n.startswith(("ramp", "pressure", "forces"))]
    return page(
        "fit",
        title=f"Table {stored.id}",
        name=stored.id,
        kind="warning" if table.warnings else "passed",
        heading=_heading(len(table.warnings)),
        headline=f"{stored.id} is {verdict(stored)}.",
        key_figures=[
            ("front pads", _pads(cal.pad_friction_f)),
            ("rear pads", _pads(cal.pad_friction_r)),
            ("of the vehicle file's", f"{100.0 * cal.pad_scale.value:.1f} %"),
            ("usable up to", f"{found.decelerations[1]:.2f} g"),
        ],
        limits=[
            ("State", stored.state.words),
            ("Range", found.limit),
            ("Front pads", budgets[0].words),
            ("Rear pads", budgets[1].words),
            ("Next", found.next.replace("`", "")),
        ],
        advice=advice_lines(budgets),
        warnings=[warned(warning) for warning in table.warnings],
        figures=_figures(stored),
        curves=drawn(panels, "f1-f2", "difference"),
        tyre=drawn(panels, "tyre", "torque-distribution"),
        budget=drawn(panels, "budget"),
        measured=drawn(panels, *of_ramps) if of_ramps else None,
        remarks=table.remarks,
        settings=[(name, f"{value:g}") for name, value in table.provenance.settings.items()],
        **origin_view(
            origin,
            table.vehicle,
            [(log.role, log.name, log.digest) for log in table.provenance.logs],
            str(mass),
        ),
    )


def _heading(warnings: int) -> str:
    if not warnings:
        return "Fitted"
    return f"Fitted, with {warnings} warning{'s' * (warnings > 1)}"


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
