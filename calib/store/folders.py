"""Names, folders and references of the versions of a store.

tables/journal.jsonl        the journal, and journal.head, see `calib.store.journal`
tables/sedan/v0001/         a version, see `calib.store.version`
tables/sedan/.new-v0002/    a version that is being written
tables/sedan/v0001.minisig  its signature
"""

import os
import re
from pathlib import Path

from calib.base.errors import StoreError, TableNotFound
from calib.base.names import TABLE_NAMES, names_a_table

RECORD, SIGNATURE, NEW = "record.json", ".minisig", ".new-"
_FOLDER = re.compile(r"v(\d{4,6})")


def checked_name(name: str) -> str:
    """Return ``name`` if it is a valid name of a table, which is always a folder of the store."""
    if not names_a_table(name):
        do = "a table has the name of its vehicle: change name in the vehicle file"
        raise StoreError(f"{name!r} cannot name a table", expected=TABLE_NAMES, do=do)
    return name


def folder_of(version: int) -> str:
    """Name of the folder of a version."""
    return f"v{version:04d}"


def numbers(home: Path) -> list[int]:
    """Version numbers of all files and folders in a table's directory, rising."""
    matches = map(_FOLDER.fullmatch, os.listdir(home) if home.is_dir() else ())
    return sorted(int(match[1]) for match in matches if match and int(match[1]) > 0)


def versions_in(home: Path) -> list[int]:
    """`numbers` of folders alone."""
    return [n for n in numbers(home) if (home / folder_of(n)).is_dir()]


def names_in(folder: Path) -> list[str]:
    """Names of the tables that have a folder with versions in a store, in order."""
    if not folder.is_dir():
        return []
    homes = (p for p in folder.iterdir() if names_a_table(p.name) and p.is_dir())
    return sorted(p.name for p in homes if versions_in(p))


def refuse_link(home: Path) -> None:
    """Raise StoreError where the folder of a table is a link, which leads out of the store."""
    if home.is_symlink():
        flaw = "the folder of a table is a link"
        do = "put the folder in its place, or withdraw its versions"
        raise StoreError(flaw, where=home, expected="a folder of its own", do=do)


def unplaced(folder: Path, name: str = "*") -> list[Path]:
    """Folders of versions that are not in their place yet, in order."""
    return sorted(p for p in folder.glob(f"{name}/{NEW}*") if names_a_table(p.parent.name))


def signature_file(home: Path, version: int) -> Path:
    """The signature file of a version."""
    return home / f"{folder_of(version)}{SIGNATURE}"


def place(home: Path, version: int) -> Path | None:
    """Folder of a version of the journal, final or still to be moved (maybe just now), or None."""
    final, new = home / folder_of(version), home / f"{NEW}{folder_of(version)}"
    return next((path for path in (final, new, final) if path.is_dir()), None)


def path_of(reference: str) -> Path | None:
    """Directory of the version if ``reference`` is a path, else None. Raises TableNotFound."""
    path = Path(reference)
    if path.name == RECORD:
        path = path.parent
    elif path.name == reference and not (path / RECORD).is_file():
        return None
    if (path / RECORD).is_file() or any(path.glob("*.parquet")):
        return path
    raise TableNotFound(
        f"no {RECORD} in it" if path.is_dir() else "is no directory",
        where=reference,
        expected="name, name@version, or the directory of one version, like v0001",
        do="give the table first, then the logs" * path.is_file(),
    )
