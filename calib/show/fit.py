"""Facts of a fit: those of its table, and the curves, the measured points and the inputs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path

from calib.base.plain import counted
from calib.base.warning import to_dict
from calib.car.mass import MassUsed
from calib.logs.log import Log
from calib.plan.achieved import Achieved
from calib.plan.achieved import document as achieved_document
from calib.show.facts import PASSED, WARNING, Facts, Picture
from calib.show.judged import origin
from calib.show.plan import achieved_facts
from calib.show.ramp import measure
from calib.show.sheet import Sheet
from calib.show.store import table_facts
from calib.show.table import table_sheet
from calib.store.figures import usability
from calib.store.version import Stored
from calib.table.budget import by_axle
from calib.table.unseen import Unseen, unseen_entries, unseen_line

_CURVES = "The curves of the table with their 95 % bands, and the measured points."


@dataclass(frozen=True)
class Fitted:
    """A version of a table that was fitted, and what it was fitted from."""

    stored: Stored
    mass: MassUsed
    ramps: Sequence[Log]
    files: Mapping[str, Path]  # other inputs by their roles
    reached: Achieved | None = None  # the widths beside those of a plan, None without a plan


def fit_facts(fitted: Fitted) -> Facts:
    """Return whether the table may be used, what limits it, and what it is made of."""
    stored, table = fitted.stored, fitted.stored.table
    facts = table_facts(stored)
    logs = [(log.role, log.name, log.digest) for log in table.provenance.logs]
    verdict, word = PASSED, "Fitted"
    if table.warnings:
        verdict, word = WARNING, f"Fitted, with {counted(len(table.warnings), 'warning')}"

    def curves() -> Sheet:
        return table_sheet(table, stored.id, tuple(measure(table, log) for log in fitted.ramps))

    return replace(
        facts,
        title=f"Table {stored.id}",
        verdict=verdict,
        word=word,
        warnings=table.warnings,
        rows=[*facts.rows, ("unseen errors", unseen_line(_unseen(fitted)))],
        pictures=[Picture(_CURVES, curves)],
        parts=[
            *([achieved_facts(fitted.reached)] if fitted.reached else []),
            Facts("The car", rows=[("mass", str(fitted.mass))]),
            *facts.parts,
            origin(stored, logs, date.today().isoformat(), fitted.files),
        ],
    )


def _unseen(fitted: Fitted) -> list[Unseen]:
    has_speed = any("v" in log for log in fitted.ramps)
    return unseen_entries(fitted.stored.table, has_speed, fitted.mass.tolerance)


def document(fitted: Fitted) -> dict[str, object]:
    """Return the JSON document of a fit."""
    stored, table = fitted.stored, fitted.stored.table
    return {
        "table": stored.id,
        "digest": stored.digest,
        "path": stored.path,
        "state": stored.state.word,
        "new": not stored.existed,
        "answer": usability(stored),
        "calibration": table.calibration,
        "budget": by_axle(table.budget.axles),
        "unseen": [entry._asdict() for entry in _unseen(fitted)],
        "effects": table.effect_values,
        "quality": table.quality,
        "remarks": table.remarks,
        "warnings": [to_dict(warning) for warning in table.warnings],
        "mass": fitted.mass,
        "plan": achieved_document(fitted.reached) if fitted.reached else None,
    }
