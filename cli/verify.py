"""`brake-cal tables verify`: which versions of a store are damaged."""

from typing import Annotated

import typer

import calib
from cli.console import emit, emit_json, say
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
    """Compare every version with digests, invariants and journal; exit code 4 if one is damaged.

    A version that is missing, replaced, edited, renumbered or unknown to the journal is damaged.
    """
    opened = calib.Store(store)
    verdicts, unfinished = opened.verify(name), opened.unfinished()
    sound = all(v.sound for v in verdicts)
    if json:
        rows = [{"id": v.id, "sound": v.sound, "violations": v.violations} for v in verdicts]
        emit_json({"store": store, "sound": sound, "versions": rows, "unfinished": unfinished})
    else:
        table = grid("table", "verdict", fold=True)
        for verdict in verdicts:
            table.add_row(verdict.id, "\n".join(verdict.violations) or "sound")
        emit(table if verdicts else f"{store} holds no table")
    for path in unfinished:
        say(f"{path}: being written, or left by a run that was stopped; the next one clears it")
    if not sound:
        raise typer.Exit(DAMAGED)
