"""`--require-signed --key PUBLIC`: use a version only with a signature that holds."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import say
from cli.project import from_settings

if TYPE_CHECKING:
    from calib.store.minisign import PublicKey
    from calib.store.version import Stored


@dataclass(frozen=True)
class Signing:
    """Whether a table must be signed, and by which key."""

    require: Annotated[
        bool,
        typer.Option(
            "--require-signed",
            help="Refuse a table without a signature that holds.",
            callback=from_settings("require_signed"),
        ),
    ] = False
    key: Annotated[
        str | None,
        typer.Option(
            "--key",
            metavar="PUBLIC",
            help="Public key that must have signed: its file, or its text.",
            callback=from_settings("public_key", when=lambda asked: bool(asked.params["require"])),
        ),
    ] = None

    def public(self) -> "PublicKey | None":
        """The key that must have signed; None where no signature is asked for.

        Raises BadParameter for one option without the other.
        """
        from calib.store.minisign import read_public_key

        require, key = self.require, self.key
        if key and not require:
            raise typer.BadParameter("only with --require-signed", param_hint="--key")
        if require and not key:
            raise typer.BadParameter(
                "needs --key PUBLIC, or public under [keys] of brake-cal.toml",
                param_hint="--require-signed",
            )
        return read_public_key(key) if key else None


def check_signed(table: str, stored: "Stored", public: "PublicKey | None") -> None:
    """Raise SignatureRefused unless a signature of the key holds; None asks for none.

    ``table`` is what was typed: a bare name means the newest version that may be used.
    """
    from calib.store.signature import require_signed

    if public is None:
        return
    found = require_signed(stored, public, newest=table == stored.name)
    say(f"{stored.id} is signed as {found.statement.state} by key {public.key_id}")
    if found.note:
        say(found.note)
