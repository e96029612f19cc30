"""`brake-cal tables sign`: a person signs a version of a table."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.console import emit, emit_json, say
from cli.options import By, Json, Store, Version, example, refuse_bare
from cli.password import typed_password
from cli.project import STORE

if TYPE_CHECKING:
    from calib.store.signature import Signed

EPILOG = example("brake-cal tables sign sedan-2up@2 --key line.key")


def sign(
    table: Version,
    *,
    key: Annotated[
        Path, typer.Option("--key", metavar="SECRET", help="Secret key, see `tables key`.")
    ],
    by: By = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Sign a version and its state.

    The signature is a file of minisign beside the folder of the version. It covers the record,
    which holds the SHA-256 of every curve, and in its trusted comment table, version, state, digest
    and the newest line of the journal. It holds until the state changes; then sign again. A
    password is asked for without echo; where stdin is no terminal, it is a line of stdin.
    """
    from calib.store import signature
    from calib.store.minisign import read_secret_key

    refuse_bare(table)
    opened = calib.Store(store)
    opened.load(table)
    secret = read_secret_key(key, lambda: typed_password("Password of the key: "))
    made = signature.sign(opened, table, secret, by or "")
    if made.note:
        say(made.note)
    _report(made, json)


def _report(made: "Signed", json: bool) -> None:
    from calib.store.folders import RECORD

    stored, record = made.stored, made.stored.path / RECORD
    if json:
        emit_json(
            {
                "schema": 1,
                "table": stored.id,
                "digest": stored.digest,
                "state": stored.state.word,
                "key_id": made.key_id,
                "record": record,
                "signature": made.path,
                "trusted_comment": made.statement.line,
            }
        )
        return
    emit(
        f"{stored.id} is signed as {stored.state.word} by key {made.key_id}\n"
        f"check it with: minisign -Vm {record} -x {made.path} -p PUBLIC"
    )
