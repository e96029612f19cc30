"""`brake-cal tables import`: content of a DCM or CDF file, compared with the table it names."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import Json, Store, example
from cli.project import STORE

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.exports.compare import Difference
    from calib.exports.read import Returned
    from calib.store.version import Stored

EPILOG = example("brake-cal tables import sedan.dcm")


def import_table(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Exported DCM or CDF file.")],
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Compare a DCM or CDF file with the table that it names.

    Nothing is stored: such a file holds the curves of a table, not their origin. Exit code 3 if it
    is cut off, damaged or names no table, 4 if it does not agree with the table. Another tool may
    have saved it: labels are compared, and numbers that were rounded agree.
    """
    from calib.exports.compare import difference, parent, refuse
    from calib.exports.read import read_back

    found = read_back(file)
    stored = parent(found, calib.Store(store))
    told = difference(found, stored)
    if json:
        emit_json(_found(found, stored, told))
    else:
        _print_found(found)
        emit(_verdict(found, stored, told))
    if told.wrong:
        raise refuse(file, told.wrong)


def _found(found: "Returned", stored: "Stored | None", told: "Difference") -> dict[str, object]:
    return {
        "schema": 1,
        "format": found.format,
        "facts": found.facts,
        "axes": found.content.axes,
        "curves": {n: {"x": x, "y": y} for n, (x, y) in found.content.curves.items()},
        "scalars": found.content.scalars,
        "units": found.units,
        "in_store": stored is not None,
        "unchanged": found.unchanged,
        "rounded": told.rounded,
        "differences": told.wrong,
    }


def _print_found(found: "Returned") -> None:
    facts = {"table": found.table} | found.facts
    width = max(map(len, facts))
    emit("\n".join(f"{key:<{width}}  {value}" for key, value in facts.items()))
    emit(_objects(found))


def _objects(found: "Returned") -> "Grid":
    table = grid("object", "points", "from", "to", "unit", fold=True)
    content, units = found.content, found.units
    arrays = {**content.axes, **{n: y for n, (_, y) in content.curves.items()}}
    for name, y in arrays.items():
        table.add_row(name, str(len(y)), f"{min(y):.6g}", f"{max(y):.6g}", units[name])
    for name, value in content.scalars.items():
        table.add_row(name, "", f"{value:.6g}", "", units[name])
    return table


def _verdict(found: "Returned", stored: "Stored | None", told: "Difference") -> str:
    if told.wrong:
        return "\n".join(f"differs: {what}" for what in told.wrong)
    if stored is None:
        return f"unchanged since it was written; {found.table} is not in this store"
    return f"agrees with {stored.id} " + (
        f"as rounded {told.rounded}" if told.rounded else "to the last bit"
    )
