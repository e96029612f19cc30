"""`brake-cal tables verify`: which versions of a store are damaged."""

from typing import Annotated

import typer

import calib
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import STORE, Json, Store, example

EPILOG = example("brake-cal tables verify")
DAMAGED = 4
"""Exit code of a damaged store, that of `StoreError`."""


def verify(
    name: Annotated[str | None, typer.Argument(help="one table; if not given, all")] = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Recompute digests and invariants of every version; exit code 4 when one is damaged."""
    verdicts = calib.Store(store).verify(name)
    sound = all(v.sound for v in verdicts)
    if json:
        rows = [{"id": v.id, "sound": v.sound, "violations": v.violations} for v in verdicts]
        emit_json({"store": store, "sound": sound, "versions": rows})
    else:
        table = grid("table", "verdict", fold=True)
        for verdict in verdicts:
            table.add_row(verdict.id, "\n".join(verdict.violations) or "sound")
        emit(table if verdicts else f"{store} holds no table")
    if not sound:
        raise typer.Exit(DAMAGED)
