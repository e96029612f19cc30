"""A car at the station: its facts, and the files of its run."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.base.digest import sha256
from calib.base.write import write_whole
from calib.estimation.limits import FAILED, WARNING
from calib.estimation.results import fill, unseen_in
from calib.estimation.results import to_dict as validation_dict
from calib.exports.export import export
from calib.line.station import files
from calib.line.station.station import TITLES, StationOutcome
from calib.show.facts import WORDS, Facts, Picture, Row, Table
from calib.show.html import page_of
from calib.show.interactive import installed
from calib.show.judged import budget_rows, judged, origin, ramp_rows, stop_by_stop
from calib.show.stop import torque_and_pads
from calib.show.table import table_sheet
from calib.show.validation import beside_best
from calib.store.state import DRAFT, REJECTED, RELEASED
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.budget import advice_lines
from calib.table.unseen import unseen_line

_STATES = {DRAFT: "a draft until a person decides", RELEASED: RELEASED, REJECTED: REJECTED}
"""State of the table in words."""
_CURVES = "f1 and f2 of the ramp, and the map that an ECU looks up, with their 95 % bands."
_MISSED = "What fails the car, and what lets it pass with a warning."


@dataclass(frozen=True)
class StationRun:
    """A car that was judged, and its stored table."""

    outcome: StationOutcome
    stored: Stored


def station_facts(run: StationRun) -> Facts:
    """Return the verdict on a car, broken limits with their next steps, and all metrics.

    Equal inputs give equal bytes of the page, as it has no path and no time of day.
    """
    outcome, stored, identity = run.outcome, run.stored, run.outcome.identity
    date = stored.state.stored_at[:10]
    car = identity.get("vin") or identity.get("serial") or stored.name
    curves = Picture(_CURVES, lambda: table_sheet(outcome.table, stored.id), ("f1-f2", "map"))
    checks_of_car = [[check] for check in outcome.checks if check.stop is None]
    of_car, unknown_of_car = judged("The car as a whole, the worst first.", checks_of_car)
    of_stops, unknown_of_stops = stop_by_stop(outcome.results)
    budgets = outcome.table.budget.axles
    next_step = "" if outcome.passed else "find the cause, and run the car again"
    if stored.state.word == DRAFT:
        next_step = f"brake-cal tables release {stored.id} --reason ... --evidence DIR/station.json"
    return Facts(
        title=f"Brake torque calibration of {car}",
        headline=f"{stored.id} is {_STATES[stored.state.word]}; {outcome.headline}",
        verdict=outcome.verdict,
        word=WORDS[outcome.verdict],
        rows=[
            *ramp_rows(outcome.table),
            ("unseen errors", unseen_line(unseen_in(stored, outcome.results))),
        ],
        tables=[_missed(outcome)],
        next=next_step,
        warnings=outcome.warnings,
        parts=[
            Facts(
                "Brake torque and pads",
                tables=[beside_best(stored, outcome.results)],
                rows=budget_rows(budgets),
                notes=advice_lines(budgets),
            ),
            Facts("Metrics", tables=[of_car, of_stops], notes=[*unknown_of_car, *unknown_of_stops]),
            Facts("The run", rows=_run(outcome, date)),
            Facts("The table", pictures=[curves]),
            Facts("The stops", pictures=[torque_and_pads(r) for r in outcome.results]),
            Facts("Remarks", notes=outcome.table.remarks),
            origin(stored, outcome.logs, date),
        ],
    )


def _missed(outcome: StationOutcome) -> Table:
    """Return a table of the broken limits, those that fail the car first, with next steps."""
    rows = [
        (check.verdict, check.text, check.action)
        for verdict in (FAILED, WARNING)
        for check in outcome.checks
        if check.verdict == verdict
    ]
    return Table(("verdict", "result", "next step"), rows, _MISSED, [row[0] for row in rows])


def _run(outcome: StationOutcome, date: str) -> list[Row]:
    return [
        ("Vehicle", outcome.table.vehicle.name),
        *((TITLES[name], value) for name, value in outcome.identity.items()),
        ("Mass", str(outcome.results[0].mass)),
        ("Date", date),
        ("Operator", outcome.by or "not stated (--by)"),
        ("Limits file", outcome.limits_file or "none: those of the program"),
        ("Golden table", outcome.golden.id if outcome.golden else "none given"),
    ]


def store_and_write(
    outcome: StationOutcome, store: Store, forms: Sequence[str], work: Path
) -> tuple[Stored, dict[str, Any]]:
    """Write all files into the folder ``work``, then store the table with its state in one step.

    Return the stored table and the document of `station.json`. The files name the version before it
    is stored; they are written again if another run took its number meanwhile. Raises OSError,
    ExchangeError, StoreError.
    """
    results = list(outcome.results)
    while True:
        stored = store.preview(outcome.table, outcome.decision(digest="to be written"))
        fill(results, validation_dict(stored, results), work)
        if not files.why_not_exported(stored):
            for form in dict.fromkeys(forms):
                export(stored, work / files.export_name(form), form)
        write_whole(work / files.JUNIT, files.junit_xml(outcome, stored))
        page = page_of(station_facts(StationRun(outcome, stored)), live=installed())
        write_whole(work / files.REPORT, page.encode())
        names = sorted(path.name for path in work.iterdir() if path.name != files.DOCUMENT)
        document = files.to_dict(outcome, stored, names)
        content = files.to_text(document).encode()
        write_whole(work / files.DOCUMENT, content)
        expected = stored
        stored = store.save(outcome.table, outcome.decision(sha256(content)))
        if (stored.id, stored.state.word) == (expected.id, expected.state.word):
            return stored, document
