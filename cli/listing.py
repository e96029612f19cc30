"""`brake-cal tables list` and `find`: the versions of a store, told apart."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.completion import names_of
from cli.console import emit, emit_json
from cli.grid import grid
from cli.inputs import require_day
from cli.options import Json, Store, example
from cli.project import STORE

if TYPE_CHECKING:
    from calib.store.listing import ListedVersion

LIST = example("brake-cal tables list", "brake-cal tables list --state released")
FIND = example("brake-cal tables find 0815")


def list_tables(
    state: Annotated[
        str | None,
        typer.Option(
            metavar="S",
            help="draft, released, rejected or withdrawn.",
            autocompletion=names_of("calib.store.state", "STATES"),
        ),
    ] = None,
    serial: Annotated[str | None, typer.Option(metavar="S", help="Serial number.")] = None,
    vin: Annotated[str | None, typer.Option(metavar="V", help="Vehicle identification.")] = None,
    since: Annotated[
        str | None, typer.Option(metavar="YYYY-MM-DD", help="Stored on this day or later.")
    ] = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """List every version of every table."""
    from calib.store.listing import chosen

    _check(state, since)
    every = _rows(store)
    rows = chosen(every, state, serial, vin, since)
    if json:
        emit_json({"schema": 1, "store": store, "tables": rows})
    elif rows:
        _print(rows)
    else:
        emit(f"{store} holds no {'such table' if every else 'table'}")


def find(
    serial: Annotated[str, typer.Argument(metavar="SERIAL", help="Serial number or VIN.")],
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Find the tables of one car by its serial number or VIN."""
    from calib.store.listing import chosen

    every = _rows(store)
    by_serial, by_vin = chosen(every, serial=serial), chosen(every, vin=serial)
    rows = [row for row in every if row in by_serial or row in by_vin]
    if not rows:
        raise typer.BadParameter(_none(serial, every), param_hint="SERIAL")
    if json:
        emit_json({"schema": 1, "store": store, "tables": rows})
    else:
        _print(rows)


def _rows(store: Path) -> "list[ListedVersion]":
    from calib.store.listing import row_of

    return [row_of(entry) for entry in calib.Store(store).list()]


def _check(state: str | None, since: str | None) -> None:
    from calib.base.toml import did_you_mean
    from calib.store.state import STATES

    if state is not None and state not in STATES:
        near = did_you_mean(state, STATES)
        raise typer.BadParameter(
            f"{state!r} is none of {', '.join(STATES)}{'; ' + near if near else ''}",
            param_hint="--state",
        )
    require_day(since, "--since")


def _none(serial: str, every: "list[ListedVersion]") -> str:
    from calib.base.toml import did_you_mean

    known = sorted({text for row in every for text in (row.serial, row.vin) if text})
    near = did_you_mean(serial, known)
    return f"no table of {serial!r}{'; ' + near if near else ''}; {len(known)} numbers are known"


def _print(rows: "list[ListedVersion]") -> None:
    heads = ("table", "state", "stored", "car", "logs", "pads f/r", "range [g]", "band", "verdict")
    table = grid(*heads, right=("logs", "band"), fold=True)
    table.collapse_padding = True  # so that a row has its line on 80 columns
    for column in (*table.columns[:3], *table.columns[4:8]):
        column.no_wrap = True
    for row in rows:
        if row.flaw:
            table.add_row(row.id, row.state, row.date[:10])
            continue
        warned = f"{row.warnings} warning{'s' * (row.warnings > 1)}" if row.warnings else ""
        table.add_row(
            row.id,
            row.state,
            row.date[:10],
            " ".join(filter(None, (row.serial, row.vin))),
            str(len(row.logs)),
            "/".join(f"{x:.3f}" for x in row.pads or ()),
            "{:.2f}-{:.2f}".format(*row.usable or (0.0, 0.0)),
            "" if row.band_width is None else f"{100 * row.band_width:.0f} %",
            ", ".join(filter(None, (row.verdict, warned, "signed" if row.keys else ""))),
        )
    emit(table)
    for row in rows:
        if row.flaw:
            emit(f"{row.id} cannot be used: {row.flaw}")
