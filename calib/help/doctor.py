"""Whether the program can work on this machine: packages, machine, store. Nothing is written."""

import os
import platform
import re
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, metadata, requires, version
from pathlib import Path

from packaging.requirements import Requirement
from packaging.version import Version

from calib.base.errors import InputError, SettingsError
from calib.base.names import NAME, STORE
from calib.base.plain import counted
from calib.base.processes import cores
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


def needs() -> Iterator[Need]:
    """Python and every package that is declared for users; not installed, Python alone."""
    lowest, lines = "", list[str]()
    with suppress(PackageNotFoundError):
        lowest = metadata(NAME)["Requires-Python"].removeprefix(">=")
        lines = requires(NAME) or []
    yield Need("python", lowest, platform.python_version())
    for asked in map(Requirement, lines):
        at_least = "".join(s.version for s in asked.specifier if s.operator == ">=")
        for extra in ("", *_EXTRAS):
            if asked.marker is None or asked.marker.evaluate({"extra": extra}):
                yield Need(asked.name, at_least, _installed(asked.name), extra)
                break


def _installed(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


@dataclass(frozen=True)
class _Finding:
    """One thing that was looked at: its ``state``, what was found, and what to do if needed."""

    name: str
    state: str
    what: str
    do: str = ""


def examine(store: Path | None = None) -> tuple[_Finding, ...]:
    """Look at everything; the ``store`` is that of the settings, or the usual one, if not given."""
    settings, usual = _settings()
    folder = tempfile.gettempdir()
    written = (FINE, "") if os.access(folder, os.W_OK) else (WRONG, "name another one by TMPDIR")
    return (
        *_packages(),
        _Finding("cores", FINE, f"{cores()} for this process"),
        _Finding("temporary files", written[0], folder, written[1]),
        _store(store or usual or STORE),
        _samples(),
        settings,
    )


def _settings() -> tuple[_Finding, Path | None]:
    """The settings file, and the store that it names."""
    from calib.base.settings_file import find_project

    try:
        project = find_project()
    except SettingsError as error:
        return _Finding("settings", WRONG, str(error), "mend the file"), None
    what = str(project.file) if project.file else "no brake-cal.toml: the usual values"
    return _Finding("settings", FINE, what), project.settings["store"]


def _packages() -> Iterator[_Finding]:
    given = list(needs())
    again = "install brake-cal again: pip install --upgrade brake-cal"
    for need in given:
        if not need.extra:
            state, do = (FINE, "") if need.met else (WRONG, again)
            yield _Finding(need.package, state, str(need), do)
    for extra, gives in _EXTRAS.items():
        its = [need for need in given if need.extra == extra]
        missing = f"if you need it: pip install 'brake-cal[{extra}]'"
        state, do = (FINE, "") if all(need.met for need in its) else (NOTE, missing)
        if its:
            yield _Finding(f"[{extra}]", state, f"{gives}: {', '.join(map(str, its))}", do)


def _store(store: Path) -> _Finding:
    if not store.exists():
        do = "the first `brake-cal fit` makes it"
        return _Finding("store", NOTE, f"{store} is not there", do)
    if not store.is_dir() or not os.access(store, os.R_OK | os.X_OK):
        what = "cannot be read" if store.is_dir() else "is a file"
        return _Finding("store", WRONG, f"{store} {what}", "name another one: --store DIR")
    versions = [len(versions_in(store / name)) for name in names_in(store)]
    what = f"{store}: {counted(sum(versions), 'version')} of {counted(len(versions), 'table')}"
    what += f", {left} unfinished" if (left := len(unplaced(store))) else ""
    if os.access(store, os.W_OK):
        return _Finding("store", FINE, what)
    return _Finding("store", NOTE, f"{what}, read only", "no table can be stored or released here")


def _samples() -> _Finding:
    try:
        return _Finding("sample logs", FINE, str(sample_logs()))
    except InputError as error:
        return _Finding("sample logs", NOTE, error.what, "`demo` and `qualify` need them")
