"""The sheets that `brake-cal plot` draws for tables and logs.

a table                     the table, with the measured points of ramps of its fit
a table and another log     the log as a stop, judged as `validate` does
a log                       its channels
"""

from collections.abc import Iterator, Sequence

from calib.car.vehicle import Vehicle
from calib.estimation.limits import DEFAULTS, Limit
from calib.estimation.validate import validate_one
from calib.logs.log import Log
from calib.run.events import run_events
from calib.show import log, stop, table
from calib.show.facts import Facts, Picture
from calib.show.ramp import measure
from calib.show.sheet import Sheet
from calib.store.version import Stored


def sheets(
    stored: Stored | None,
    logs: Sequence[Log],
    vehicle: Vehicle | None = None,
    limits: tuple[Limit, ...] = DEFAULTS,
) -> Iterator[Sheet]:
    """Yield the sheets of a table and logs, or of logs alone.

    Stops are judged by ``limits``, with the nominal pads of ``vehicle`` in place of the table's.
    Raises LogError and VehicleError as `validate_one`.
    """
    if stored is None:
        yield from map(_of_log, logs)
    else:
        parents = map(stored.table.provenance.fitted_log_of, logs)
        roles = [parent.role if parent else "" for parent in parents]  # "" for no log of the fit
        ramps = [run for run, role in zip(logs, roles, strict=True) if role == "ramp"]
        if ramps or not logs:
            measured = tuple(measure(stored.table, ramp) for ramp in ramps)
            yield table.table_sheet(stored.table, stored.id, measured)
        for run, role in zip(logs, roles, strict=True):
            if not role:
                result = validate_one(stored.table, run, vehicle, limits)
                yield stop.of_validation(result, stored.id, vehicle)
            elif role != "ramp":
                yield _of_log(run)  # a coast has no braked sample


def _of_log(run: Log) -> Sheet:
    return log.log_sheet(log.whole_of(run), run_events(run))


def sheet_facts(drawn: Sequence[Sheet], figure: str | None = None) -> Facts:
    """Return the sheets as facts of a page, with the panel ``figure`` of each or all panels."""
    parts = [_part(sheet, [figure] if figure else sheet.laid_out) for sheet in drawn]
    return parts[0] if len(parts) == 1 else Facts(f"{len(parts)} sheets", parts=parts)


def _part(sheet: Sheet, names: Sequence[str]) -> Facts:
    picture = Picture(sheet.note, lambda: sheet, names)
    return Facts(sheet.title, headline=sheet.result, pictures=[picture])
