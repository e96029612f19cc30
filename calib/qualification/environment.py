"""What a result was computed with: interpreter, operating system, processor and packages."""

import platform
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from calib.program import NAME

EXTRAS = {
    "mdf": "logs as MDF (.mf4, .mdf, .dat)",
    "can": "bus logs (.blf, .asc, .trc, candump) with DBC, ARXML, KCD or SYM",
    "sign": "signatures of tables",
    "dist": "batch on a Dask scheduler",
}
"""Extras that change what the program does, with what each gives; others are for work on it."""


def environment() -> dict[str, str]:
    """Names and values of what the program runs on; a value may be empty where it is not told."""
    return {
        "interpreter": f"{platform.python_implementation()} {platform.python_version()}",
        "compiler": platform.python_compiler(),
        "operating system": platform.platform(),
        "machine": platform.machine(),
        "processor": _processor(),
    }


def packages() -> dict[str, str]:
    """Version of every installed package that the program may load, by name.

    Those that it declares, with those that they declare in turn. Empty where the program runs from
    a folder without being installed.
    """
    found: dict[str, str] = {}
    waiting = _names(NAME, EXTRAS)
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        try:
            found[name] = version(name)
        except PackageNotFoundError:  # an extra that is not installed, or for another system
            continue
        waiting += _names(name, ())
    return dict(sorted(found.items()))


def _names(name: str, extras: Collection[str]) -> list[str]:
    return [re.sub(r"[-_.]+", "-", one.package).lower() for one in declared(name, extras)]


@dataclass(frozen=True)
class Declared:
    """A package that another one needs: its ``lowest`` version and the ``extra``, "" for none."""

    package: str
    lowest: str
    extra: str


def declared(name: str, extras: Collection[str]) -> Iterator[Declared]:
    """What a package declares, with that of its ``extras``; nothing if it is not installed."""
    try:
        lines = requires(name) or []
    except PackageNotFoundError:
        return
    for line in lines:
        extra = re.search(r"extra\s*==\s*['\"]([^'\"]+)", line)
        word = re.match(r"[\w.-]+", line)
        if word and (extra is None or extra[1] in extras):
            lowest = re.search(r">=\s*([\w.]+)", line.partition(";")[0])
            yield Declared(word[0], lowest[1] if lowest else "", extra[1] if extra else "")


def _processor() -> str:
    """Name of the processor, as Linux tells it; elsewhere what Python knows."""
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return platform.processor()
    named = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
    return named[1] if named else platform.processor()
