"""Names, folders and references of the versions of a store.

tables/journal.jsonl        the journal, and journal.head, see `calib.store.journal`
tables/sedan/               the folder of a table; functions call it ``home``
tables/sedan/v0001/         the folder of version 1, see `calib.store.version`
tables/sedan/v0001.minisig  the signature of version 1
tables/sedan/.new-v0002/    version 2 while it is written
"""

import os
import re
from pathlib import Path

from calib.base.errors import StoreError, TableNotFound
from calib.base.names import TABLE_NAME_RULE, names_a_table

RECORD, SIGNATURE_SUFFIX, NEW_PREFIX = "record.json", ".minisig", ".new-"
_FOLDER = re.compile(r"v(\d{4,6})")


def checked_name(name: str) -> str:
    """Return ``name`` if a table may have it as its name. Raises StoreError."""
    if not names_a_table(name):
        do = "a table has the name of its vehicle: change name in the vehicle file"
        raise StoreError(f"{name!r} cannot name a table", expected=TABLE_NAME_RULE, do=do)
    return name


def folder_of(version: int) -> str:
    """Return the name of the folder of a version."""
    return f"v{version:04d}"


def taken_numbers(home: Path) -> list[int]:
    """Return the numbers of all versions whose name a file or folder in ``home`` has, rising."""
    matches = map(_FOLDER.fullmatch, os.listdir(home) if home.is_dir() else ())
    return sorted(int(match[1]) for match in matches if match and int(match[1]) > 0)


def versions_in(home: Path) -> list[int]:
    """Return the numbers of the folders of versions in ``home``, rising."""
    return [n for n in taken_numbers(home) if (home / folder_of(n)).is_dir()]


def names_in(folder: Path) -> list[str]:
    """Return the names of the tables whose versions are in the store ``folder``, in order."""
    paths = folder.iterdir() if folder.is_dir() else ()
    return sorted(p.name for p in paths if names_a_table(p.name) and versions_in(p))


def refuse_link(home: Path) -> None:
    """Raise StoreError where ``home`` is a link, which may lead out of the store."""
    if home.is_symlink():
        do = "put the folder in its place, or withdraw its versions"
        raise StoreError("is a link", where=home, expected="the folder of a table", do=do)


def unplaced(folder: Path, name: str = "*") -> list[Path]:
    """Return the folders of versions without a final name yet, of one table or of all tables."""
    paths = folder.glob(f"{name}/{NEW_PREFIX}*")
    return sorted(path for path in paths if names_a_table(path.parent.name))


def signature_file(home: Path, version: int) -> Path:
    """Return the path of the signature file of a version."""
    return home / f"{folder_of(version)}{SIGNATURE_SUFFIX}"


def existing_folder(home: Path, version: int) -> Path | None:
    """Return the folder of a version with its final or its new name; None if there is neither."""
    final, new = home / folder_of(version), home / f"{NEW_PREFIX}{folder_of(version)}"
    # another process may rename new to final after the first test, so final is tested twice
    return next((path for path in (final, new, final) if path.is_dir()), None)


def path_of(reference: str) -> Path | None:
    """Return the folder of a version if ``reference`` is a path; None if it names a table.

    Raises TableNotFound for a path at which there is no version.
    """
    path = Path(reference)
    if path.name == RECORD:
        path = path.parent
    has_record = (path / RECORD).is_file()
    if path.name == reference and not has_record:  # no folder stands before the name
        return None
    if has_record or any(path.glob("*.parquet")):  # a damaged version may lack its record
        return path
    raise TableNotFound(
        f"no {RECORD} in it" if path.is_dir() else "is no directory",
        where=reference,
        expected="name, name@version, or the directory of one version, like v0001",
        do="if it is a log: give the table first" if path.is_file() else "",
    )
