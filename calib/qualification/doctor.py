"""Whether the program can work on this machine: packages, machine, store. Nothing is written."""

import fcntl
import importlib.util
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from calib.demo.samples import sample_logs
from calib.errors import InputError
from calib.messages.plain import counted
from calib.processes import cores
from calib.qualification.environment import EXTRAS
from calib.qualification.needs import Need, needs
from calib.store.folders import names_in, unplaced, versions_in

FINE, NOTE, WRONG = "fine", "note", "wrong"
"""States: as it should be, something is limited, the program cannot work."""

FONT = Path("mpl-data/fonts/ttf/DejaVuSans.ttf")
"""The font of all pictures; it is a part of matplotlib."""
LEAST_MEMORY = 1.0
"""Memory [GB] below which a large log may not be read: a reader takes up to 1 GB."""


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at: its ``state``, what was found, and what to do if needed."""

    name: str
    state: str
    what: str
    do: str = ""


def examine(store: Path) -> tuple[Finding, ...]:
    """Look at everything but settings and terminal, which are the command line's."""
    return (*_packages(), *_extras(), *_pictures(), *_machine(), *_store(store), *_samples())


def _packages() -> Iterator[Finding]:
    for need in needs():
        if not need.extra:
            state = FINE if need.met else WRONG
            do = "" if need.met else "install brake-cal again: pip install --upgrade brake-cal"
            yield Finding(need.package, state, str(need), do)


def _extras() -> Iterator[Finding]:
    by_extra: dict[str, list[Need]] = {name: [] for name in EXTRAS}
    for need in needs():
        if need.extra:
            by_extra[need.extra].append(need)
    for name, given in by_extra.items():
        if not given:
            continue
        there = all(need.met for need in given)
        what = ", ".join(str(need) for need in given)
        yield Finding(
            f"[{name}]",
            FINE if there else NOTE,
            f"{EXTRAS[name]}: {what}",
            "" if there else f"if you need it: pip install 'brake-cal[{name}]'",
        )


def _pictures() -> Iterator[Finding]:
    spec = importlib.util.find_spec("matplotlib")
    if spec is None or spec.origin is None:
        return  # told among the packages
    there = (Path(spec.origin).parent / FONT).is_file()
    what = "DejaVu Sans, of matplotlib" if there else "DejaVu Sans is missing in matplotlib"
    yield Finding(
        "font", FINE if there else NOTE, what, "" if there else "install matplotlib again"
    )


def _machine() -> Iterator[Finding]:
    yield Finding("cores", FINE, f"{cores()} for this process")
    memory = free_memory()
    if memory is not None:
        enough = memory >= LEAST_MEMORY
        do = "" if enough else "large logs need up to 1 GB"
        yield Finding("memory", FINE if enough else NOTE, f"{memory:.1f} GB free", do)
    folder = Path(tempfile.gettempdir())
    good = os.access(folder, os.W_OK)
    do = "" if good else "name another one by the variable TMPDIR"
    yield Finding("temporary files", FINE if good else WRONG, str(folder), do)


def free_memory() -> float | None:
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
