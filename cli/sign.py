"""`brake-cal tables sign`, and the signatures that other commands require."""

import sys
from dataclasses import dataclass
from getpass import getpass
from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import Answer, command
from cli.console import say, usage_error
from cli.options import Required, SignedBy, Tables, argument, option

if TYPE_CHECKING:
    from calib.store.minisign import PublicKey
    from calib.store.version import Stored


@command(
    "brake-cal tables sign --key line.key --new-key line.pub --no-password",
    "brake-cal tables sign sedan-2up@2 --key line.key",
)
def sign(
    table: str | None = argument("Version to sign.", "TABLE@N"),
    *,
    key: Path = option("File of the secret key.", "SECRET"),
    new_key: Path | None = option("Make SECRET and this public key.", "PUBLIC"),
    no_password: bool = option("Do not protect a new key by a password."),
    store: Tables,
) -> Answer:
    """Sign a version and its state.

    The signature is a file of minisign beside the folder of the version. It covers every curve and
    the history so far, and holds until the state changes; then sign again.

    With --new-key a pair of keys is made instead, both files of minisign. The password of a key is
    asked for without echo, that of a new key twice; if stdin is no terminal, it is a line of stdin.
    """
    from calib.store import signature
    from calib.store.folders import RECORD
    from calib.store.minisign import read_secret_key

    if new_key is not None:
        return _new_pair(table, key, new_key, no_password)
    if no_password:
        raise usage_error("only with --new-key", "--no-password")
    if table is None or "@" not in table:
        raise usage_error("expected name@version, see `brake-cal tables list`", "TABLE@N")
    store.load(table)  # raises before a password is asked for
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
        raise usage_error("makes keys and signs no table; leave TABLE@N out", "--new-key")
    password = ""
    if not no_password:
        password = _typed("Password of the new key (empty: none): ")
        if password != _typed("The same once more: "):
            raise usage_error("the two passwords differ; no key was made")
    pair = generate(secret, public, password)
    document = {"key_id": pair.key_id, "public_key": pair.text, "secret": secret}
    document |= {"public": public, "password": bool(password)}
    protection = "protected by the password" if password else "without a password"
    text = f"key {pair.key_id}\nsecret key in {secret}, {protection}: who has it can sign as you\n"
    return Answer(document, f"{text}public key in {public}: {pair.text}")


def _typed(prompt: str) -> str:
    """Read a password from the terminal, without echo, or else one line of stdin."""
    try:
        return getpass(prompt) if sys.stdin.isatty() else input()
    except (EOFError, UnicodeDecodeError):
        raise usage_error("no password was typed") from None


@dataclass(frozen=True)
class Signed:
    """Options of a command that may require a signature of a table."""

    require_signed: Required
    key: SignedBy

    @property
    def public(self) -> "PublicKey | None":
        """The key that must have signed the table, None if no signature is required."""
        from calib.store.minisign import read_public_key

        if self.key and not self.require_signed:
            raise usage_error("only with --require-signed", "--key")
        if self.require_signed and not self.key:
            flaw = "needs --key PUBLIC, or public under [keys] of brake-cal.toml"
            raise usage_error(flaw, "--require-signed")
        return read_public_key(self.key) if self.key else None

    def check(self, table: str, stored: "Stored") -> None:
        """Raise SignatureRefused for a version without the required signature.

        If ``table``, as typed, is a bare name, ``stored`` is the newest version that may be used.
        """
        from calib.store.signature import require_signed

        public = self.public
        if public is None:
            return
        signature = require_signed(stored, public, newest=table == stored.name)
        say(f"{stored.id} is signed as {stored.state.word} by key {public.key_id}")
        if signature.note:
            say(signature.note)
