"""`brake-cal tables key`: a new pair of keys that signs tables."""

from pathlib import Path
from typing import Annotated

import typer

from cli.console import emit, emit_json
from cli.options import Json, example
from cli.password import new_password

EPILOG = example("brake-cal tables key --secret line.key --public line.pub --no-password")


def key(
    secret: Annotated[
        Path, typer.Option("--secret", metavar="FILE", help="Secret key to write; keep it.")
    ],
    public: Annotated[
        Path, typer.Option("--public", metavar="FILE", help="Public key to write; hand it out.")
    ],
    no_password: Annotated[
        bool, typer.Option("--no-password", help="Do not protect the secret key by a password.")
    ] = False,
    json: Json = False,
) -> None:
    """Make a pair of keys that signs tables.

    Both are files of minisign. The password is asked for twice, without echo; where stdin is no
    terminal, it is two lines of stdin. An existing file is not replaced.
    """
    from calib.store.minisign import generate

    password = "" if no_password else new_password()
    made = generate(secret, public, password)
    if json:
        emit_json(
            {
                "schema": 1,
                "key_id": made.key_id,
                "public_key": made.text,
                "secret": secret,
                "public": public,
                "password": bool(password),
            }
        )
        return
    protection = "protected by the password" if password else "without a password"
    emit(
        f"key {made.key_id}\n"
        f"secret key in {secret}, {protection}: who has it can sign in your name\n"
        f"public key in {public}: {made.text}"
    )
