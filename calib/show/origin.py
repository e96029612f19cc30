"""Where the results of a page come from: files with their digests, versions, date."""

import platform
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from calib.base.digest import file_digest
from calib.base.names import PROGRAM
from calib.show.facts import Facts
from calib.show.facts import Table as Cells
from calib.store.version import Stored

_PACKAGES = ("numpy", "scipy", "matplotlib")
"""Packages that compute and draw."""
_DIGESTS = "Inputs, with the SHA-256 of their bytes."


@dataclass(frozen=True)
class PageOrigin:
    """``date`` as it stands on the page; ``files`` (role, name, SHA-256) that are no logs."""

    date: str = ""
    files: tuple[tuple[str, str, str], ...] = ()


def origin_of(date: str, files: Mapping[str, Path | None]) -> PageOrigin:
    """The origin with the files that were given, by role. Raises OSError for one that is gone."""
    given = [(role, path.name, file_digest(path)) for role, path in files.items() if path]
    return PageOrigin(date, tuple(given))


def origin(given: PageOrigin, stored: Stored, logs: Iterable[tuple[str, str, str]]) -> Facts:
    """Where the results come from; ``logs`` (role, name, SHA-256)."""
    packages = [f"{name} {version(name)}" for name in _PACKAGES]
    inputs = [(name, role, digest) for role, name, digest in (*logs, *given.files)]
    return Facts(
        "Where it comes from",
        rows=[
            ("Table", f"{stored.id}, SHA-256 {stored.digest}"),
            ("Date", given.date or "not stated"),
            ("Program", PROGRAM),
            ("Runs on", ", ".join([f"Python {platform.python_version()}", *packages])),
        ],
        tables=[Cells(("file", "role", "SHA-256"), inputs, _DIGESTS)],
    )
