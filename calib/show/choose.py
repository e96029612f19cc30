"""The sheet that is drawn for the given tables, logs and results.

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
from calib.show import compare, log, stop, table
from calib.show.facts import Facts, Picture
from calib.show.ramp import measure
from calib.show.result import StoredResult
from calib.show.sheet import Sheet
from calib.store.version import Stored


@dataclass(frozen=True)
class PlotInput:
    """The inputs of a drawing; ``vehicle`` gives nominal pads other than the table's.

    A stop is judged by ``limits``.
    """

    tables: tuple[Stored, ...] = ()
    logs: tuple[Log, ...] = ()
    results: tuple[StoredResult, ...] = ()
    vehicle: Vehicle | None = None
    limits: tuple[Limit, ...] = DEFAULTS


def sheets(given: PlotInput) -> Iterator[Sheet]:
    """The sheets of the given inputs, one after the other.

    Raises ValueError for more than two tables, and for two with logs; LogError and VehicleError as
    `validate_one`.
    """
    if len(given.tables) == 2 and not given.logs:
        a, b = given.tables
        yield compare.sheet(a.table, b.table, a.id, b.id)
    elif len(given.tables) == 1:
        yield from _of_table(given.tables[0], given)
    elif not given.tables:
        yield from map(_of_log, given.logs)
    else:
        raise ValueError("two tables are drawn without logs, three or more cannot be drawn")
    for result in given.results:
        yield stop.of_result(result)


def facts(drawn: Sequence[Sheet], figure: str | None = None) -> Facts:
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


def _of_table(stored: Stored, given: PlotInput) -> Iterator[Sheet]:
    parents = [stored.table.provenance.parent_of(found) for found in given.logs]
    roles = [None if parent is None else parent.role for parent in parents]
    ramps = [found for found, role in zip(given.logs, roles, strict=True) if role == "ramp"]
    if ramps or not given.logs:
        measured = tuple(measure(stored.table, ramp) for ramp in ramps)
        yield table.sheet(stored.table, stored.id, measured)
    for found, role in zip(given.logs, roles, strict=True):
        if role is None:
            yield _of_stop(stored, found, given)
        elif role != "ramp":
            yield _of_log(found)  # a coast has no braked sample


def _of_log(found: Log) -> Sheet:
    return log.sheet(log.whole_of(found), run_events(found))


def _of_stop(stored: Stored, found: Log, given: PlotInput) -> Sheet:
    used, car = stored.table, given.vehicle
    result = validate_one(used, found, car, given.limits)
    return stop.of_validation(used, stored.id, found, result, car)
