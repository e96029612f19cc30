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

    from calib.exports.returned import Returned
    from calib.store.version import Stored

EPILOG = example("brake-cal tables import sedan.dcm")


def import_table(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Exported DCM or CDF file.")],
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Compare a DCM or CDF file with the table that it names.

    Nothing is stored: such a file holds the curves of a table, not their origin. Exit code 3 if it
    is cut off or damaged, 4 if it does not agree with its checksum or its digest.
    """
    from calib.exports.read import differences, parent, read_back, refuse

    found = read_back(file)
    stored = parent(found, calib.Store(store))
    wrong = differences(found, stored)
    if json:
        emit_json(_found(found, stored, wrong))
    else:
        _print_found(found)
        emit(_verdict(found, stored, wrong))
    if wrong:
        raise refuse(file, wrong)


def _found(found: "Returned", stored: "Stored | None", wrong: list[str]) -> dict[str, object]:
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
        "differences": wrong,
    }


def _print_found(found: "Returned") -> None:
    width = max(map(len, found.facts))
    emit("\n".join(f"{key:<{width}}  {value}" for key, value in found.facts.items()))
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


def _verdict(found: "Returned", stored: "Stored | None", wrong: list[str]) -> str:
    if wrong:
        return "\n".join(f"differs: {what}" for what in wrong)
    if stored is None:
        return f"unchanged since it was written; {found.facts['table']} is not in this store"
    return f"agrees with {stored.id} to the last bit"
