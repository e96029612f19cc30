"""Facts of a fit: may the table be used, what limits it, its curves, its inputs."""

from collections.abc import Sequence
from dataclasses import dataclass

from calib.base.plain import counted
from calib.base.warning import to_dict
from calib.car.vehicle import MassUsed
from calib.logs.log import Log
from calib.show.facts import PASSED, WARNING, Facts, Picture, Table
from calib.show.judged import budget_rows, ramp_rows
from calib.show.origin import PageOrigin, origin
from calib.show.ramp import measure
from calib.show.sheet import Sheet
from calib.show.table import sheet
from calib.store.figures import answer, effect_figures, verdict
from calib.store.version import Stored
from calib.table.budget import advice_lines, limiting
from calib.table.budget import summary as budget_summary

_CURVES = "The curves of the table with their 95 % bands, and the measured points."


@dataclass(frozen=True)
class Fitted:
    """A version of a table, fitted on a car of ``mass``; ``ramps`` are its logs with braking."""

    stored: Stored
    mass: MassUsed
    ramps: Sequence[Log]
    origin: PageOrigin


def facts(found: Fitted) -> Facts:
    """May the table be used, what limits it, what is it made of."""
    stored, mass = found.stored, found.mass
    table, said, cal = stored.table, answer(stored), stored.table.calibration
    logs = [(log.role, log.name, log.digest) for log in table.provenance.logs]
    budgets, count = table.budget.axles, len(table.warnings)
    advice = advice_lines(budgets)
    details = Facts(
        "What was estimated",
        rows=[
            ("state", stored.state.words),
            ("mass", str(mass)),
            ("pads over the vehicle file's", f"{100.0 * cal.pad_scale.value:.1f} %"),
            *budget_rows(budgets),
        ],
        tables=[_estimated(stored)],
        notes=[*advice[1:], *table.remarks],
    )
    return Facts(
        title=f"Table {stored.id}",
        headline=verdict(stored),
        verdict=WARNING if count else PASSED,
        word=f"Fitted, with {counted(count, 'warning')}" if count else "Fitted",
        numbers=ramp_rows(table),
        rows=[("range", said.ends), ("limited by", limiting(budgets))],
        notes=advice[:1],
        next=said.next,
        warnings=table.warnings,
        pictures=[Picture(_CURVES, lambda: _sheet(found))],
        parts=[details, origin(found.origin, stored, logs)],
    )


def _sheet(found: Fitted) -> Sheet:
    stored = found.stored
    measured = tuple(measure(stored.table, log) for log in found.ramps)
    return sheet(stored.table, stored.id, measured)


def _estimated(stored: Stored) -> Table:
    """What was estimated beside the pads, and how far the ramp went."""
    q = stored.table.quality
    rows = [
        (f"{of.effect}: {of.name}".replace("_", " "), f"{of.value.value:.4g}",
         "{:.4g} to {:.4g}".format(*of.ci95), of.unit)
        for of in effect_figures(stored.table)
    ]  # fmt: skip
    rows += [
        ("Deceleration that the ramp reached", f"{q['deceleration_max']:.2f}", "", "g"),
        ("Largest eta - 1", f"{100.0 * (q['eta_peak'] - 1.0):.2f}", "", "%"),
        ("Deceleration at the largest eta", f"{q['eta_peak_deceleration']:.2f}", "", "g"),
        ("Front axle locks first up to", f"{q['front_biased_up_to']:.2f}", "", "g"),
    ]
    return Table(("", "value", "95 % interval", "unit"), rows)


def document(found: Fitted) -> dict[str, object]:
    """The JSON document of a fit."""
    stored, table = found.stored, found.stored.table
    return {
        "table": stored.id,
        "digest": stored.digest,
        "path": stored.path,
        "state": stored.state.word,
        "new": not stored.existed,
        "answer": answer(stored),
        "calibration": table.calibration,
        "budget": budget_summary(*table.budget.axles),
        "effects": table.effect_values,
        "quality": table.quality,
        "remarks": table.remarks,
        "warnings": [to_dict(warning) for warning in table.warnings],
        "mass": found.mass,
    }
