"""Where the results of a page come from: table, date, program, and files with their digests."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from calib.base.digest import file_digest
from calib.base.names import PROGRAM
from calib.show.facts import Facts, Table
from calib.store.version import Stored

_DIGESTS = "Inputs, with the SHA-256 of their bytes."


def origin(
    stored: Stored,
    logs: Iterable[tuple[str, str, str]],
    date: str,
    files: Mapping[str, Path] | None = None,
) -> Facts:
    """Return the part of a page that says where its results come from.

    ``logs`` are roles, names and SHA-256; ``files`` are other inputs by their roles. Raises OSError
    for a file that is gone.
    """
    inputs = [(name, role, digest) for role, name, digest in logs]
    inputs += [(path.name, role, file_digest(path)) for role, path in (files or {}).items()]
    return Facts(
        "Where it comes from",
        rows=[
            ("Table", f"{stored.id}, SHA-256 {stored.digest}"),
            ("Date", date),
            ("Program", PROGRAM),
        ],
        tables=[Table(("file", "role", "SHA-256"), inputs, _DIGESTS)],
    )
