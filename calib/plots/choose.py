"""The sheet that is drawn for the given tables, logs and results.

a table                     the table; with the ramps it was made of, also their measured points
two tables                  one against the other
a table and another log     the stop with the estimate; as a simulation if the log has truth
a log, a result             the log, the result
"""

from collections.abc import Iterator
from dataclasses import dataclass

from calib.estimation.estimator import estimate
from calib.logs.log import Log
from calib.physics.vehicle import Vehicle
from calib.plots import compare, log, simulation, stop, table
from calib.plots.measured import measure
from calib.plots.result import StoredResult
from calib.plots.sheet import Sheet
from calib.plots.trace import from_estimate, from_result
from calib.store.version import Stored
from calib.table.table import Table


@dataclass(frozen=True)
class PlotInput:
    """The inputs of a drawing; ``vehicle`` gives nominal pads other than the table's."""

    tables: tuple[Stored, ...] = ()
    logs: tuple[Log, ...] = ()
    results: tuple[StoredResult, ...] = ()
    vehicle: Vehicle | None = None


def sheets(given: PlotInput) -> Iterator[Sheet]:
    """The sheets of the given inputs, one after the other.

    At most two tables; two tables without logs or results. Raises ValueError otherwise, and for a
    vehicle that no estimate and no result uses; LogError for a log that the estimator refuses.
    """
    if len(given.tables) == 2 and not given.logs:
        a, b = given.tables
        yield compare.sheet(a.table, b.table, a.id, b.id)
    elif len(given.tables) == 1:
        yield from _of_table(given.tables[0], given.logs, given.vehicle)
    elif not given.tables:
        yield from map(log.sheet, given.logs)
    else:
        raise ValueError("two tables are drawn without logs, three or more cannot be drawn")
    for result in given.results:
        yield stop.sheet(from_result(result, given.vehicle))


def _of_table(stored: Stored, logs: tuple[Log, ...], vehicle: Vehicle | None) -> Iterator[Sheet]:
    roles = {parent.digest: parent.role for parent in stored.table.provenance.logs}
    ramps = [found for found in logs if roles.get(found.digest) == "ramp"]
    if ramps or not logs:
        measured = tuple(measure(stored.table, ramp) for ramp in ramps)
        yield table.sheet(stored.table, stored.id, measured)
    for found in logs:
        if found.digest not in roles:
            yield _of_stop(stored.table, stored.id, found, vehicle)
        elif roles[found.digest] != "ramp":
            yield log.sheet(found)  # a coast has no braked sample


def _of_stop(used: Table, name: str, found: Log, vehicle: Vehicle | None) -> Sheet:
    trace = from_estimate(used, name, found, estimate(used, found, vehicle), vehicle)
    return simulation.sheet(trace) if trace.has_truth else stop.sheet(trace)
