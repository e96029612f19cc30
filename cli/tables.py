"""`brake-cal tables`: the commands on a store, and the list of its versions."""

import typer

import calib
from cli import derive, diff, export, merge, read_back, show, verify
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import STORE, Json, Store, example

app = typer.Typer(
    rich_markup_mode=None, no_args_is_help=True, epilog=example("brake-cal tables list")
)


@app.callback()
def tables() -> None:
    """List, show, compare, verify, export and import tables of the store."""


@app.command("list", epilog=example("brake-cal tables list"))
def list_tables(store: Store = STORE, json: Json = False) -> None:
    """List every version of every table."""
    entries = calib.Store(store).list()
    if json:
        rows = [{"id": e.id, **vars(e)} for e in entries]
        emit_json({"store": store, "tables": rows})
        return
    table = grid("table", "digest", "logs", fold=True)
    for entry in entries:
        digest = entry.digest[:12] if entry.digest else "cannot be read"
        table.add_row(entry.id, digest, ", ".join(entry.logs))
    emit(table if entries else f"{store} holds no table")


app.command(epilog=show.EPILOG)(show.show)
app.command(epilog=diff.EPILOG)(diff.diff)
app.command(epilog=verify.EPILOG)(verify.verify)
app.command("export", epilog=export.EPILOG)(export.export_table)
app.command("import", epilog=read_back.EPILOG)(read_back.import_table)
app.command(epilog=merge.EPILOG)(merge.merge)
app.command(epilog=derive.EPILOG)(derive.derive)
