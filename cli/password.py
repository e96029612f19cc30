"""Passwords of keys: typed without echo, or read from a pipe as minisign does."""

import sys
from getpass import getpass
from typing import NoReturn

import typer


def new_password() -> str:
    """A new password, typed twice; empty means none.

    Raises BadParameter if the two differ.
    """
    first = typed_password("Password of the new key (empty: none): ")
    if first != typed_password("The same once more: "):
        raise typer.BadParameter("the two passwords differ; nothing was made")
    return first


def typed_password(prompt: str) -> str:
    """A password from the terminal, without echo, or one line of stdin where that is no terminal.

    Raises BadParameter if nothing comes.
    """
    if sys.stdin.isatty():
        try:
            return getpass(prompt)
        except (EOFError, UnicodeDecodeError):
            _refuse()
    line = sys.stdin.buffer.readline()
    if not line:
        _refuse()
    return line.decode("utf-8", "surrogateescape").rstrip("\r\n")


def _refuse() -> NoReturn:
    raise typer.BadParameter("no password was typed") from None
