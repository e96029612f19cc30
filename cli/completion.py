"""What a shell offers at the Tab key: tables of the store, and names that the program knows.

Only folders are read for tables, no file of a table. Names that stand in the library load what
defines them, when they are asked for.
"""

import contextlib
import io
import os
import tomllib
from collections.abc import Callable, Iterable
from importlib import import_module
from pathlib import Path
from typing import Any

import typer

from cli.project import STORE

VARIABLE = "_BRAKE_CAL_COMPLETE"
"""Environment variable by which a shell asks: complete_bash, complete_zsh, complete_fish."""

AT = "@"


def table_names(context: typer.Context, incomplete: str) -> list[str]:
    """Names of the tables; of one that is written in full, or alone, its versions as well."""
    from calib.store.folders import names_in

    store = _store(context)
    names = [name for name in names_in(store) if name.startswith(incomplete.partition(AT)[0])]
    if AT in incomplete:
        return _versions(store, names)
    return [*names, *(_versions(store, names) if len(names) == 1 else ())]


def table_versions(context: typer.Context, incomplete: str) -> list[str]:
    """``name@version`` of every table, the newest first."""
    from calib.store.folders import names_in

    store = _store(context)
    begun = incomplete.partition(AT)[0]
    return _versions(store, [name for name in names_in(store) if name.startswith(begun)])


def bare_names(context: typer.Context, incomplete: str) -> list[str]:
    """Names of the tables."""
    from calib.store.folders import names_in

    return names_in(_store(context))


def names_of(module: str, name: str) -> Callable[[str], list[str]]:
    """Completion by the names in a constant of the program, a mapping or a sequence."""

    def completer(incomplete: str) -> list[str]:
        return [str(one) for one in getattr(import_module(module), name)]

    return completer


def _versions(store: Path, names: Iterable[str]) -> list[str]:
    from calib.store.folders import versions_in

    return [f"{name}{AT}{n}" for name in names for n in reversed(versions_in(store / name))]


def _store(context: typer.Context) -> Path:
    """The store of the command line, of the settings file, or the usual one."""
    given = context.params.get("store")
    return Path(given) if given and Path(given) != STORE else _of_settings() or STORE


def _of_settings() -> Path | None:
    """The store of the settings file, read without a check of the rest; None without one."""
    from calib.base.settings import VARIABLE, find_settings

    named = os.environ.get(VARIABLE)
    try:
        file = (Path(named) if named else None) if named is not None else find_settings(Path.cwd())
        store = tomllib.loads(file.read_text(encoding="utf-8")).get("store") if file else None
    except (OSError, ValueError):
        return None
    return file.parent / store if file and isinstance(store, str) else None


def answer(complete: Callable[[], Any]) -> int:
    """Let typer complete for bash, which breaks words at `@`; returns the exit code.

    bash asks for ``car @ 2`` where ``car@2`` was typed, and puts an answer behind the `@`.
    """
    words, at = os.environ.get("COMP_WORDS", "").split("\n"), _number(os.environ.get("COMP_CWORD"))
    joined, current = rejoined(words, at)
    os.environ |= {"COMP_WORDS": "\n".join(joined), "COMP_CWORD": str(current)}
    code, told = 0, io.StringIO()
    with contextlib.redirect_stdout(told):
        try:
            complete()
        except SystemExit as end:
            code = int(end.code or 0)
    whole = joined[current] if len(joined) > current and joined != words else ""
    behind = whole[: whole.rfind(AT) + 1]
    typer.echo("\n".join(line.removeprefix(behind) for line in told.getvalue().splitlines()))
    return code


def rejoined(words: list[str], at: int) -> tuple[list[str], int]:
    """Words with those around an `@` put together, and the place of the current one.

    >>> rejoined(["brake-cal", "tables", "show", "car", "@", "2"], 5)
    (['brake-cal', 'tables', 'show', 'car@2'], 3)
    """
    joined: list[str] = []
    current = at
    for place, word in enumerate(words):
        if joined and place > 1 and (word == AT or joined[-1].endswith(AT)):
            joined[-1] += word
        else:
            joined.append(word)
        if place == at:
            current = len(joined) - 1
    return joined, current


def _number(written: str | None) -> int:
    return int(written) if written and written.isdecimal() else 0
