"""`brake-cal tables verify`: which versions of a store are damaged."""

from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.completion import bare_names
from cli.console import emit, emit_json, say
from cli.grid import grid
from cli.options import Json, PublicKey, Store, example
from cli.project import STORE

if TYPE_CHECKING:
    from calib.store.store import StoreVerdict

EPILOG = example("brake-cal tables verify", "brake-cal tables verify sedan-2up")
DAMAGED = 4
"""Exit code of a damaged store, that of `StoreError`."""


def verify(
    name: Annotated[
        str | None, typer.Argument(help="one table; if not given, all", autocompletion=bare_names)
    ] = None,
    key: PublicKey = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Say which versions of a store are damaged.

    Compares each with its digests, its invariants and the journal; exit code 4 if one is damaged. A
    version that is missing, replaced, edited, renumbered or unknown to the journal is damaged.
    With --key also the signatures: every released version must have one of this key, each must be
    of this version in its present state, and the journal must contain what was signed and what was
    seen before with this key.
    """
    opened = calib.Store(store)
    verdicts, note = _trusted(opened, key, name) if key else (opened.verify(name), "")
    unfinished = opened.unfinished()
    sound = all(v.sound for v in verdicts)
    if json:
        rows = [{"id": v.id, "sound": v.sound, "violations": v.violations} for v in verdicts]
        if key:
            rows = [{**r, "signed": v.signed} for r, v in zip(rows, verdicts, strict=True)]
        emit_json(
            {
                "schema": 1,
                "store": store,
                "sound": sound,
                "versions": rows,
                "unfinished": unfinished,
            }
        )
    else:
        table = grid("table", "verdict", fold=True)
        for verdict in verdicts:
            good = f"sound, {_signature(verdict.signed)}" if key else "sound"
            table.add_row(verdict.id, "\n".join(verdict.violations) or good)
        emit(table if verdicts else f"{store} holds no table")
    for path in unfinished:
        say(f"{path}: being written, or left by a run that was stopped; the next one clears it")
    if note:
        say(note)
    if not sound:
        raise typer.Exit(DAMAGED)


def _trusted(
    store: "calib.Store", key: str, name: str | None
) -> "tuple[tuple[StoreVerdict, ...], str]":
    from calib.store.minisign import read_public_key
    from calib.store.signature import verify_signed

    return verify_signed(store, read_public_key(key), name)


def _signature(state: str | None) -> str:
    return f"signed as {state}" if state else "not signed by this key"
