"""Whether the program can work on this machine: its packages, the store and the settings."""

import os
import platform
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import distributions
from pathlib import Path

from packaging.requirements import Requirement

from calib.base.errors import SettingsError
from calib.base.extras import EXTRAS
from calib.base.names import NAME, PROGRAM, STORE
from calib.base.plain import counted
from calib.show.facts import Facts, Table
from calib.store.folders import names_in, versions_in

FINE, NOTE, WRONG = "fine", "note", "wrong"
"""States of what is examined: it is right, it limits the program, or it stops the program."""


def environment() -> dict[str, str]:
    """Return interpreter, operating system, machine and processor; a value may be empty."""
    processor = platform.processor()
    with suppress(OSError):  # Linux names the processor only there
        text = Path("/proc/cpuinfo").read_text()
        model = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
        processor = model[1] if model else processor
    return {
        "interpreter": f"{platform.python_implementation()} {platform.python_version()}",
        "operating system": platform.platform(),
        "machine": platform.machine(),
        "processor": processor,
    }


def packages() -> Iterator[tuple[Requirement, str, str]]:
    """Yield each package that users need, its installed version and its extra; "" for none."""
    declared = next((x.requires for x in distributions(name=NAME)), None)
    for need in map(Requirement, declared or ()):
        installed = next((x.version for x in distributions(name=need.name)), "")
        for extra in ("", *EXTRAS):  # extras for developers are left out
            if need.marker is None or need.marker.evaluate({"extra": extra}):
                yield need, installed, extra
                break


@dataclass(frozen=True)
class _Finding:
    name: str  # of what was examined
    state: str
    text: str  # what was found
    do: str = ""


def examine(store: Path | None = None) -> tuple[_Finding, ...]:
    """Examine packages, store and settings; without ``store`` that of the settings, or `STORE`."""
    from calib.base.settings_file import find_project

    store_of_settings = None
    try:
        project = find_project()
        store_of_settings = project.settings["store"]
        file = str(project.file or "no brake-cal.toml: the usual values")
        settings = _Finding("settings", FINE, file)
    except SettingsError as error:
        settings = _Finding("settings", WRONG, str(error), "mend the file")
    of_packages = [_package(*package) for package in packages()]
    return (*of_packages, _store(store or store_of_settings or STORE), settings)


def _package(need: Requirement, installed: str, extra: str) -> _Finding:
    text = f"{installed or 'missing'} (needs {need.specifier})"
    if installed and need.specifier.contains(installed, prereleases=True):
        state, do = FINE, ""
    elif extra:
        state, do = NOTE, f"for {EXTRAS[extra]}: pip install '{NAME}[{extra}]'"
    else:
        state, do = WRONG, f"install it again: pip install --upgrade {NAME}"
    return _Finding(f"{need.name} [{extra}]" if extra else need.name, state, text, do)


def _store(store: Path) -> _Finding:
    if not store.exists():
        do = "the first `brake-cal fit` makes it"
        return _Finding("store", NOTE, f"{store} is not there", do)
    if not store.is_dir() or not os.access(store, os.R_OK | os.X_OK):
        fault = "cannot be read" if store.is_dir() else "is a file"
        return _Finding("store", WRONG, f"{store} {fault}", "name another one: --store DIR")
    versions = [len(versions_in(store / name)) for name in names_in(store)]
    text = f"{store}: {counted(sum(versions), 'version')} of {counted(len(versions), 'table')}"
    if os.access(store, os.W_OK):
        return _Finding("store", FINE, text)
    return _Finding("store", NOTE, f"{text}, read only", "no table can be stored or released here")


def doctor_facts(findings: Sequence[_Finding]) -> Facts:
    """Return a table of the findings that are not `FINE`, and a part with all of them."""
    wrong = [finding.name for finding in findings if finding.state == WRONG]
    verdict = f"cannot work here: {', '.join(wrong)}" if wrong else "can work here"
    rows = [(x.name, x.state, f"{x.text}; {x.do}" if x.do else x.text) for x in findings]
    heads = ("what", "state", "found")
    return Facts(
        headline=f"{PROGRAM} {verdict}",
        tables=[Table(heads, [row for row in rows if row[1] != FINE])],
        parts=[Facts("All that was looked at", tables=[Table(heads, rows)])],
    )
