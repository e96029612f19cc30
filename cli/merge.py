"""`brake-cal tables merge`: the mean table of several cars of one model."""

from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.completion import table_versions
from cli.console import emit, emit_json, say
from cli.grid import grid
from cli.options import Json, Store, example
from cli.project import STORE

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.store.version import Stored
    from calib.table.table import Table

EPILOG = example("brake-cal tables merge car@1 car@2 car@3 --name golden")


def merge(
    tables: Annotated[
        list[str],
        typer.Argument(
            metavar="CAR@1 CAR@2 ...",
            help="name@version or path, one of each car",
            autocompletion=table_versions,
        ),
    ],
    *,
    name: Annotated[str, typer.Option(metavar="NAME", help="Name of the mean table.")],
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Store the mean of several cars as a golden table.

    With the spread between them. Random effects: the spread between cars by REML, the interval of
    the mean after Hartung and Knapp. Its bands are those of one more car of the model.
    """
    from calib.store.merge import merge as mean_of

    _check_name(name)
    kept = calib.Store(store)
    stored = kept.save(mean_of([kept.load(table) for table in tables], name))
    if json:
        emit_json(_document(stored))
        return
    for parent in stored.table.provenance.parents:
        say(f"of {parent.id} ({parent.digest[:12]})")
    emit(mean_grid(stored.table))
    for remark in stored.table.remarks:
        emit(f"- {remark}")
    emit(f"stored {stored.id}")


def mean_grid(table: "Table") -> "Grid":
    """The figures of a mean table."""
    from calib.store.figures import mean_figures

    rows = grid("of the mean", "value", "95 % of the mean", "sigma between cars", fold=True)
    for one in mean_figures(table):
        half, between = (f"{100.0 * share:.2f} %" for share in (one.half_width, one.between))
        # zero is what is left where the cars differ by no more than their own noise
        seen = between if one.between > 0.0 else "less than noise"
        rows.add_row(one.name, f"{one.value:.4g}", f"+- {half}", seen)
    return rows


def _check_name(name: str) -> None:
    from calib.store.folders import NAME

    if not NAME.fullmatch(name) or ".." in name:
        raise typer.BadParameter(
            f"{name!r} cannot name a table; letters, digits and . _ - only", param_hint="--name"
        )


def _document(stored: "Stored") -> dict[str, object]:
    from calib.store.figures import mean_figures

    table = stored.table
    eta = table.difference.eta
    return {
        "schema": 1,
        **stored.address,
        "parents": table.provenance.parents,
        "cars": table.spread.cars if table.spread else 1,
        "eta": [eta[0], eta[-1]],
        "figures": mean_figures(table),
        "remarks": table.remarks,
        "warnings": table.warnings,
    }
