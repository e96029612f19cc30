"""The sheets that are drawn for the given tables, logs and results.

a table                     the table; with the ramps it was made of, also their measured points
two tables                  one against the other
a table and another log     the stop, judged as `validate` does; a simulation if it has truth
a log, a result             the log, the result
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from calib.car.vehicle import Vehicle
from calib.estimation.limits import DEFAULTS, Limit
from calib.estimation.validate import validate_one
from calib.logs.log import Log
from calib.run.events import run_events
from calib.show import log, stop, table
from calib.show.facts import Facts, Picture
from calib.show.ramp import measure
from calib.show.result import StoredResult
from calib.show.sheet import Sheet
from calib.store.version import Stored


@dataclass(frozen=True)
class PlotInput:
    """Inputs of a drawing; ``vehicle`` replaces the nominal pads, ``limits`` judge a stop."""

    tables: tuple[Stored, ...] = ()
    logs: tuple[Log, ...] = ()
    results: tuple[StoredResult, ...] = ()
    vehicle: Vehicle | None = None
    limits: tuple[Limit, ...] = DEFAULTS


def sheets(inputs: PlotInput) -> Iterator[Sheet]:
    """Yield the sheets of one table with its logs, or of two tables, and of each result.

    Raises LogError and VehicleError as `validate_one`.
    """
    if len(inputs.tables) == 2:
        yield table.two_tables({one.id: one.table for one in inputs.tables})
    elif inputs.tables:
        yield from _of_table(inputs.tables[0], inputs)
    else:
        yield from map(_of_log, inputs.logs)
    yield from map(stop.of_result, inputs.results)


def sheet_facts(drawn: Sequence[Sheet], figure: str | None = None) -> Facts:
    """The sheets as facts of a page, each with the one ``figure`` or with all of its layout."""
    parts = [
        Facts(
            one.title,
            headline=one.result,
            pictures=[
                Picture(one.note, partial(replace, one), [figure] if figure else one.laid_out)
            ],
        )
        for one in drawn
    ]
    return parts[0] if len(parts) == 1 else Facts(f"{len(parts)} sheets", parts=parts)


def _of_table(stored: Stored, inputs: PlotInput) -> Iterator[Sheet]:
    parents = [(run, stored.table.provenance.parent_of(run)) for run in inputs.logs]
    ramps = [run for run, parent in parents if parent and parent.role == "ramp"]
    if ramps or not inputs.logs:
        measured = tuple(measure(stored.table, ramp) for ramp in ramps)
        yield table.table_sheet(stored.table, stored.id, measured)
    for run, parent in parents:
        if parent is None:
            result = validate_one(stored.table, run, inputs.vehicle, inputs.limits)
            yield stop.of_validation(stored.table, stored.id, run, result, inputs.vehicle)
        elif parent.role != "ramp":
            yield _of_log(run)  # a coast has no braked sample


def _of_log(run: Log) -> Sheet:
    return log.log_sheet(log.whole_of(run), run_events(run))
