"""`--require-signed --key PUBLIC`: use a version only with a signature that holds."""

from typing import TYPE_CHECKING

from cli.console import misuse, say

if TYPE_CHECKING:
    from calib.store.minisign import PublicKey
    from calib.store.version import Stored


def key_of(required: bool, key: str | None) -> "PublicKey | None":
    """The key that must have signed; None where no signature is asked for."""
    from calib.store.minisign import read_public_key

    if key and not required:
        raise misuse("only with --require-signed", "--key")
    if required and not key:
        raise misuse(
            "needs --key PUBLIC, or public under [keys] of brake-cal.toml", "--require-signed"
        )
    return read_public_key(key) if key else None


def check_signed(table: str, stored: "Stored", public: "PublicKey | None") -> None:
    """Raise SignatureRefused unless a signature of the key holds; None asks for none.

    ``table`` is what was typed: a bare name means the newest version that may be used.
    """
    from calib.store.signature import require_signed

    if public is not None:
        found = require_signed(stored, public, newest=table == stored.name)
        say(f"{stored.id} is signed as {found.statement.state} by key {public.key_id}")
        if found.note:
            say(found.note)
