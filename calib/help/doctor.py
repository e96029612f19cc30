"""Whether the program can work on this machine: packages, machine, store. Nothing is written."""

import os
import platform
import re
import tempfile
from collections.abc import Collection, Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, metadata, requires, version
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from calib.base.errors import InputError, SettingsError
from calib.base.plain import counted
from calib.base.processes import cores
from calib.base.program import NAME
from calib.base.settings import STORE
from calib.help.samples import sample_logs
from calib.store.folders import names_in, unplaced, versions_in

FINE, NOTE, WRONG = "fine", "note", "wrong"
"""States: as it should be, something is limited, the program cannot work."""

_EXTRAS = {
    "mdf": "logs as MDF (.mf4, .mdf, .dat)",
    "can": "bus logs (.blf, .asc, .trc, candump) with DBC, ARXML, KCD or SYM",
    "sign": "signatures of tables",
    "dist": "batch on a Dask scheduler",
}
"""Extras that change what the program does, with what each gives; others are for work on it."""


def environment() -> dict[str, str]:
    """Names and values of what the program runs on; a value may be empty where it is not told."""
    processor = platform.processor()
    with suppress(OSError):  # Linux tells its name here alone
        text = Path("/proc/cpuinfo").read_text()
        named = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
        processor = named[1] if named else processor
    return {
        "interpreter": f"{platform.python_implementation()} {platform.python_version()}",
        "compiler": platform.python_compiler(),
        "operating system": platform.platform(),
        "machine": platform.machine(),
        "processor": processor,
    }


@dataclass(frozen=True)
class Need:
    """A package: ``lowest`` version declared, the one ``found``, its ``extra``; "" for none."""

    package: str
    lowest: str
    found: str
    extra: str = ""

    @property
    def met(self) -> bool:
        """Whether it is there in a version that holds."""
        return bool(self.found) and Version(self.found) >= Version(self.lowest or "0")

    def __str__(self) -> str:
        lowest = f" (needs {self.lowest} or later)" if self.lowest else ""
        return f"{self.package} {self.found or 'is missing'}{lowest}"


def needs() -> tuple[Need, ...]:
    """Python and every package that is declared for users; not installed, Python alone."""
    lowest = ""
    with suppress(PackageNotFoundError):
        lowest = metadata(NAME)["Requires-Python"].removeprefix(">=")
    return Need("python", lowest, platform.python_version()), *_declared(NAME, _EXTRAS)


def packages() -> dict[str, str]:
    """Version of every installed package that is declared, or by one of those in turn."""
    found: dict[str, str] = {}
    waiting = [*_declared(NAME, _EXTRAS)]
    while waiting:
        need = waiting.pop()
        name = canonicalize_name(need.package)
        if need.found and name not in found:  # without an extra that is not installed
            found[name] = need.found
            waiting += _declared(name, ())
    return dict(sorted(found.items()))


def _declared(name: str, extras: Collection[str]) -> Iterator[Need]:
    """What a package declares, with that of its ``extras``; nothing if it is not installed."""
    lines: list[str] = []
    with suppress(PackageNotFoundError):
        lines = requires(name) or []
    for asked in map(Requirement, lines):
        marker = asked.marker
        for extra in ("", *extras):
            if marker is None or marker.evaluate({"extra": extra}):
                lowest, found = [s.version for s in asked.specifier if s.operator == ">="], ""
                with suppress(PackageNotFoundError):
                    found = version(asked.name)
                yield Need(asked.name, "".join(lowest), found, extra)
                break


@dataclass(frozen=True)
class _Finding:
    """One thing that was looked at: its ``state``, what was found, and what to do if needed."""

    name: str
    state: str
    what: str
    do: str = ""


def _judged(name: str, good: bool, what: str, do: str, otherwise: str = NOTE) -> _Finding:
    return _Finding(name, FINE if good else otherwise, what, "" if good else do)


def examine(store: Path | None = None) -> tuple[_Finding, ...]:
    """Look at everything; the ``store`` is that of the settings, or the usual one, if not given."""
    settings, usual = _settings()
    found = (*_packages(), *_machine(), *_store(store or usual or STORE), *_samples())
    return (*found, settings)


def _settings() -> tuple[_Finding, Path | None]:
    """The settings file, and the store that it names."""
    from calib.base.settings_file import find_project

    try:
        project = find_project()
    except SettingsError as error:
        return _Finding("settings", WRONG, str(error), "mend the file"), None
    what = str(project.file) if project.file else "no brake-cal.toml: the usual values"
    return _Finding("settings", FINE, what), project.settings.store


def _packages() -> Iterator[_Finding]:
    given = needs()
    again = "install brake-cal again: pip install --upgrade brake-cal"
    for need in given:
        if not need.extra:
            yield _judged(need.package, need.met, str(need), again, WRONG)
    for extra, gives in _EXTRAS.items():
        if its := [need for need in given if need.extra == extra]:
            do = f"if you need it: pip install 'brake-cal[{extra}]'"
            what = f"{gives}: {', '.join(map(str, its))}"
            yield _judged(f"[{extra}]", all(need.met for need in its), what, do)


def _machine() -> Iterator[_Finding]:
    yield _Finding("cores", FINE, f"{cores()} for this process")
    folder = tempfile.gettempdir()
    do = "name another one by the variable TMPDIR"
    yield _judged("temporary files", os.access(folder, os.W_OK), folder, do, WRONG)


def _store(store: Path) -> Iterator[_Finding]:
    if not store.exists():
        yield _Finding("store", NOTE, f"{store} is not there", "the first `brake-cal fit` makes it")
        return
    if not store.is_dir() or not os.access(store, os.R_OK | os.X_OK):
        what = "cannot be read" if store.is_dir() else "is a file"
        yield _Finding("store", WRONG, f"{store} {what}", "name another one: --store DIR")
        return
    versions = [len(versions_in(store / name)) for name in names_in(store)]
    writable, left = os.access(store, os.W_OK), len(unplaced(store))
    parts = [
        f"{store}: {counted(sum(versions), 'version')} of {counted(len(versions), 'table')}",
        "" if writable else "read only",
        f"{left} unfinished" if left else "",
    ]
    do = "no table can be stored or released here"
    yield _judged("store", writable, ", ".join(filter(None, parts)), do)


def _samples() -> Iterator[_Finding]:
    try:
        yield _Finding("sample logs", FINE, str(sample_logs()))
    except InputError as error:
        yield _Finding("sample logs", NOTE, error.what, "`demo` and `qualify` need them")
