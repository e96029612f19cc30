"""Whether the program can work on this machine: packages, machine, store. Nothing is written."""

import fcntl
import importlib.util
import os
import platform
import re
import shutil
import sys
import tempfile
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, metadata, requires, version
from pathlib import Path

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

_FONT = Path("mpl-data/fonts/ttf/DejaVuSans.ttf")
"""The font of all pictures; it is a part of matplotlib."""
_LEAST_MEMORY = 1.0
"""Memory [GB] below which a large log may not be read: a reader takes up to 1 GB."""


def environment() -> dict[str, str]:
    """Names and values of what the program runs on; a value may be empty where it is not told."""
    return {
        "interpreter": f"{platform.python_implementation()} {platform.python_version()}",
        "compiler": platform.python_compiler(),
        "operating system": platform.platform(),
        "machine": platform.machine(),
        "processor": _processor(),
    }


def _processor() -> str:
    """Name of the processor, as Linux tells it; elsewhere what Python knows."""
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return platform.processor()
    named = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
    return named[1] if named else platform.processor()


@dataclass(frozen=True)
class Need:
    """A package: the ``lowest`` version that is declared, the one ``found``, "" for none.

    ``extra`` that it belongs to, "" for one that is always needed.
    """

    package: str
    lowest: str
    found: str
    extra: str = ""

    @property
    def met(self) -> bool:
        """Whether the package is there in a version that holds."""
        return bool(self.found) and _number(self.found) >= _number(self.lowest)

    def __str__(self) -> str:
        lowest = f" (needs {self.lowest} or later)" if self.lowest else ""
        return f"{self.package} {self.found or 'is missing'}{lowest}"


def needs() -> tuple[Need, ...]:
    """Python, and every package that the program declares for users.

    Empty but for Python where the program runs from a folder without being installed.
    """
    try:
        lowest = metadata(NAME)["Requires-Python"].removeprefix(">=")
    except PackageNotFoundError:
        lowest = ""
    return Need("python", lowest, platform.python_version()), *_declared(NAME, _EXTRAS)


def packages() -> dict[str, str]:
    """Version of every installed package that the program may load, by name.

    Those that it declares, with those that they declare in turn. Empty where the program runs from
    a folder without being installed.
    """
    found: dict[str, str] = {}
    waiting = [*_declared(NAME, _EXTRAS)]
    while waiting:
        need = waiting.pop()
        name = re.sub(r"[-_.]+", "-", need.package).lower()
        if need.found and name not in found:  # without an extra that is not installed
            found[name] = need.found
            waiting += _declared(name, ())
    return dict(sorted(found.items()))


def _declared(name: str, extras: Collection[str]) -> Iterator[Need]:
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
            installed = _installed(word[0])
            yield Need(word[0], lowest[1] if lowest else "", installed, extra[1] if extra else "")


def _installed(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def _number(written: str) -> tuple[int, ...]:
    """The leading numbers of a version: 2.10.1rc1 is (2, 10, 1)."""
    digits = re.match(r"\d+(?:\.\d+)*", written)
    return tuple(int(part) for part in digits[0].split(".")) if digits else ()


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at: its ``state``, what was found, and what to do if needed."""

    name: str
    state: str
    what: str
    do: str = ""


def examine(store: Path | None = None) -> tuple[Finding, ...]:
    """Look at everything; the ``store`` is that of the settings, or the usual one, if not given."""
    settings, usual = _settings()
    found = (*_packages(), *_pictures(), *_machine(), *_store(store or usual or STORE), *_samples())
    return (*found, settings, *_terminal())


def _settings() -> tuple[Finding, Path | None]:
    """The settings file, and the store that it names."""
    from calib.base.settings_file import find_project

    try:
        project = find_project()
    except SettingsError as error:
        return Finding("settings", WRONG, str(error), "mend the file"), None
    what = str(project.file) if project.file else "no brake-cal.toml: the usual values"
    return Finding("settings", FINE, what), project.settings.store


def _terminal() -> Iterator[Finding]:
    width, kind = shutil.get_terminal_size().columns, "terminal" if sys.stdout.isatty() else "pipe"
    encoding = sys.stdout.encoding or "unknown"
    plain = encoding.lower().replace("-", "") == "utf8"
    do = "" if plain else "set PYTHONUTF8=1 for names with other letters"
    yield Finding("output", FINE if plain else NOTE, f"{kind}, {width} columns, {encoding}", do)


def _packages() -> Iterator[Finding]:
    by_extra: dict[str, list[Need]] = {name: [] for name in _EXTRAS}
    for need in needs():
        if need.extra:
            by_extra[need.extra].append(need)
            continue
        state = FINE if need.met else WRONG
        do = "" if need.met else "install brake-cal again: pip install --upgrade brake-cal"
        yield Finding(need.package, state, str(need), do)
    for name, given in by_extra.items():
        if given:
            there = all(need.met for need in given)
            do = "" if there else f"if you need it: pip install 'brake-cal[{name}]'"
            what = f"{_EXTRAS[name]}: {', '.join(map(str, given))}"
            yield Finding(f"[{name}]", FINE if there else NOTE, what, do)


def _pictures() -> Iterator[Finding]:
    spec = importlib.util.find_spec("matplotlib")
    if spec is None or spec.origin is None:
        return  # told among the packages
    if (Path(spec.origin).parent / _FONT).is_file():
        yield Finding("font", FINE, "DejaVu Sans, of matplotlib")
    else:
        what = "DejaVu Sans is missing in matplotlib"
        yield Finding("font", NOTE, what, "install matplotlib again")


def _machine() -> Iterator[Finding]:
    yield Finding("cores", FINE, f"{cores()} for this process")
    memory = _free_memory()
    if memory is not None:
        enough = memory >= _LEAST_MEMORY
        do = "" if enough else "large logs need up to 1 GB"
        yield Finding("memory", FINE if enough else NOTE, f"{memory:.1f} GB free", do)
    folder = Path(tempfile.gettempdir())
    good = os.access(folder, os.W_OK)
    do = "" if good else "name another one by the variable TMPDIR"
    yield Finding("temporary files", FINE if good else WRONG, str(folder), do)


def _free_memory() -> float | None:
    """Memory that can be used [GB]; None where the system does not tell."""
    try:
        return float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")) / 1e9
    except (AttributeError, ValueError, OSError):
        return None


def _store(store: Path) -> Iterator[Finding]:
    if not store.exists():
        yield Finding("store", NOTE, f"{store} is not there", "the first `brake-cal fit` makes it")
        return
    if not store.is_dir() or not os.access(store, os.R_OK | os.X_OK):
        what = "cannot be read" if store.is_dir() else "is a file"
        yield Finding("store", WRONG, f"{store} {what}", "name another one: --store DIR")
        return
    versions = [len(versions_in(store / name)) for name in names_in(store)]
    what = f"{store}: {counted(sum(versions), 'version')} of {counted(len(versions), 'table')}"
    writable = os.access(store, os.W_OK)
    what += "" if writable else ", read only"
    what += ", being written by another process" if _is_locked(store) else ""
    left = len(unplaced(store))
    what += f", {left} unfinished" if left else ""
    do = "" if writable else "no table can be stored or released here"
    yield Finding("store", FINE if writable else NOTE, what, do)


def _is_locked(store: Path) -> bool:
    """Whether another process writes in the store now."""
    handle = os.open(store, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return True
    finally:
        os.close(handle)
    return False


def _samples() -> Iterator[Finding]:
    try:
        yield Finding("sample logs", FINE, str(sample_logs()))
    except InputError as error:
        yield Finding("sample logs", NOTE, error.what, "`demo` and `qualify` need them")
