"""`brake-cal tables sign`, and what other commands ask of signatures by --require-signed."""

import sys
from dataclasses import dataclass
from getpass import getpass
from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import Answer, command
from cli.console import misuse, say
from cli.options import Required, SignedBy, Tables, argument, option

if TYPE_CHECKING:
    from calib.store.minisign import PublicKey
    from calib.store.version import Stored


@command(
    "brake-cal tables sign --key line.key --new-key line.pub --no-password",
    "brake-cal tables sign sedan-2up@2 --key line.key",
)
def sign(
    table: str | None = argument("name@version", "TABLE@N"),
    *,
    key: Path = option("Secret key; keep it.", "SECRET"),
    new_key: Path | None = option("Make a pair: write SECRET, and this to hand out.", "PUBLIC"),
    no_password: bool = option("With --new-key: do not protect the secret key by a password."),
    store: Tables,
) -> Answer:
    """Sign a version and its state.

    The signature is a file of minisign beside the folder of the version. It covers every curve and
    the history so far, and holds until the state changes; then sign again.

    With --new-key it makes a pair of keys instead, both files of minisign. A password is asked for
    without echo, of a new key twice; where stdin is no terminal, it is a line of stdin.
    """
    from calib.store import signature
    from calib.store.folders import RECORD
    from calib.store.minisign import read_secret_key

    if new_key is not None:
        return _new_pair(table, key, new_key, no_password)
    if no_password:
        raise misuse("only with --new-key", "--no-password")
    if table is None or "@" not in table:
        raise misuse("give name@version, see `brake-cal tables list`")
    store.load(table)
    secret = read_secret_key(key, lambda: _typed("Password of the key: "))
    signed = signature.sign(store, table, secret)
    if signed.note:
        say(signed.note)
    stored = signed.stored
    text = f"{stored.id} is signed as {stored.state.word} by key {signed.key_id}"
    check = f"minisign -Vm {stored.path / RECORD} -x {signed.path} -p PUBLIC"
    return Answer(signed.to_dict(), f"{text}\ncheck it with: {check}")


def _new_pair(table: str | None, secret: Path, public: Path, no_password: bool) -> Answer:
    from calib.store.minisign import generate

    if table is not None:
        raise misuse("makes a key and signs no table", "--new-key")
    password = "" if no_password else _typed("Password of the new key (empty: none): ")
    if not no_password and password != _typed("The same once more: "):
        raise misuse("the two passwords differ; nothing was made")
    pair = generate(secret, public, password)
    key = {"key_id": pair.key_id, "public_key": pair.text}
    protection = "protected by the password" if password else "without a password"
    return Answer(
        {**key, "secret": secret, "public": public, "password": bool(password)},
        f"key {pair.key_id}\n"
        f"secret key in {secret}, {protection}: who has it can sign in your name\n"
        f"public key in {public}: {pair.text}",
    )


def _typed(prompt: str) -> str:
    """A password from the terminal, without echo, or else one line of stdin."""
    try:
        return getpass(prompt) if sys.stdin.isatty() else input()
    except (EOFError, UnicodeDecodeError):
        raise misuse("no password was typed") from None


@dataclass(frozen=True)
class Signed:
    """Signature that a command requires of a table."""

    require_signed: Required
    key: SignedBy

    @property
    def public(self) -> "PublicKey | None":
        """The key that must have signed; None where no signature is asked for."""
        from calib.store.minisign import read_public_key

        if self.key and not self.require_signed:
            raise misuse("only with --require-signed", "--key")
        if self.require_signed and not self.key:
            where = "needs --key PUBLIC, or public under [keys] of brake-cal.toml"
            raise misuse(where, "--require-signed")
        return read_public_key(self.key) if self.key else None

    def check(self, table: str, stored: "Stored") -> None:
        """Raise SignatureRefused unless a signature of the key holds, if one is asked for.

        ``table`` is what was typed: a bare name means the newest version that may be used.
        """
        from calib.store.signature import require_signed

        if public := self.public:
            signature = require_signed(stored, public, newest=table == stored.name)
            say(f"{stored.id} is signed as {stored.state.word} by key {public.key_id}")
            if signature.note:
                say(signature.note)
