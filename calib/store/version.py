"""One version of a table as a directory: a record, one Parquet file per curve, digests.

    v0001/record.json           {id, version, digest, parents, files, states, record}
          difference.parquet    D(eta)
          paper.parquet         f1(eta), f2(eta)
          tyre.parquet          g(slip)

``digest`` is that of the table's content and does not depend on the file format; ``files`` holds
the SHA-256 of each Parquet file, so that a damaged file is detected before it is parsed. ``states``
names the journal that holds the state of the version; a version older than the journal has no such
key.
"""

import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from calib.base.bounded import TABLE, read_bounded
from calib.base.digest import content_digest
from calib.base.errors import DamagedTable, StoreError
from calib.base.write import sync
from calib.store.curve_file import Array, curve_bytes, read_curve
from calib.store.folders import RECORD
from calib.store.journal import JOURNAL, without_duplicates
from calib.store.state import UNKNOWN, VersionState
from calib.table.table import Table

if TYPE_CHECKING:
    from calib.base.record import Section

    S = TypeVar("S", bound=Section)

CURVES = ("difference", "paper", "tyre")


@dataclass(frozen=True)
class Stored:
    """A table with its address.

    ``digest`` is that of its content, ``path`` its directory, ``record`` the SHA-256 of its record
    file, "" of one that is not written yet; ``journaled`` whether that file names a journal;
    ``existed`` whether `Store.save` found it there already.
    """

    table: Table
    name: str
    version: int
    digest: str
    path: Path
    record: str = ""
    journaled: bool = False
    state: VersionState = UNKNOWN
    existed: bool = False

    def __repr__(self) -> str:
        return f"{self.id} in {self.path}\n{self.table!r}"

    @property
    def id(self) -> str:
        """name@version."""
        return f"{self.name}@{self.version}"

    @property
    def address(self) -> dict[str, object]:
        """Which table it is and where: the head of every document about it."""
        named = {"id": self.id, "name": self.name, "version": self.version}
        return {**named, "digest": self.digest, "path": self.path}


def write_curves(table: Table, path: Path) -> None:
    """Write the curves' files into the directory ``path``, which must not be a version yet."""
    _, curves = table.content()
    for name in CURVES:
        _write(path / f"{name}.parquet", curve_bytes(curves[name]))


def write_record(table: Table, version: int, path: Path) -> None:
    """Write the record of ``version`` beside the curves' files and flush the directory to disk."""
    record, _ = table.content()
    digests = {
        f"{name}.parquet": hashlib.sha256(_bytes(path / f"{name}.parquet")).hexdigest()
        for name in CURVES
    }
    document = {**_document(record, table.digest, version, digests), "states": JOURNAL}
    _write(path / RECORD, (json.dumps(document, indent=2, sort_keys=True) + "\n").encode())
    sync(path)


def read_version(path: Path, promised: str | None = None) -> Stored:
    """Read one version and compare it with its digests.

    ``promised`` is the id that belongs to its place in a store. Raises DamagedTable naming the part
    that differs, StoreError when it cannot be read at all.
    """
    from calib.store.record_file import RecordFile, table_of

    data = _bytes(path / RECORD)
    file = _checked(data, RecordFile, path)
    document = _single_keys(data, path)
    record = document["record"]
    try:
        curves = {name: _curve_file(path / f"{name}.parquet", file.files) for name in CURVES}
        if content_digest(record, curves) != file.digest:
            raise _damaged(path, f"{RECORD}: the record or its digest was changed")
        table = table_of(file.record, curves)
    except (KeyError, TypeError, ValueError) as error:
        raise _damaged(path, f"{RECORD}: not the record of these curves ({error!r})") from error
    expected = _document(record, file.digest, file.version, file.files)
    if file.states is not None:
        expected["states"] = JOURNAL
    stored = Stored(
        table,
        table.name,
        file.version,
        file.digest,
        path,
        record=hashlib.sha256(data).hexdigest(),
        journaled=file.states is not None,
    )
    changed = sorted(k for k in {*expected, *document} if expected.get(k) != document.get(k))
    if changed:
        raise _damaged(path, f"{RECORD}: {', '.join(changed)} not in agreement with the record")
    if promised not in (None, stored.id):
        raise _damaged(path, f"{RECORD}: holds {stored.id} in the place of {promised}")
    return stored


def _document(
    record: dict[str, Any], digest: str, version: int, files: dict[str, str]
) -> dict[str, Any]:
    logs = record["provenance"]["logs"]
    return {
        "id": f"{record['name']}@{version}",
        "version": version,
        "digest": digest,
        "parents": [{"name": log["name"], "digest": log["digest"]} for log in logs],
        "files": files,
        "record": record,
    }


def _checked(data: bytes, schema: "type[S]", path: Path) -> "S":
    from calib.base.record import validated

    try:
        return validated(data, schema, None, DamagedTable)
    except DamagedTable as error:
        raise _damaged(path, f"{RECORD}: {error}") from error


def _single_keys(data: bytes, path: Path) -> dict[str, Any]:
    try:
        document: dict[str, Any] = json.loads(data, object_pairs_hook=without_duplicates)
    except (ValueError, RecursionError) as error:
        raise _damaged(path, f"{RECORD}: {error}") from error
    return document


def _curve_file(path: Path, digests: dict[str, str]) -> dict[str, Array]:
    """Columns of one curve, after its bytes were compared with their digest."""
    data = _bytes(path)
    if hashlib.sha256(data).hexdigest() != digests[path.name]:
        raise _damaged(path.parent, f"{path.name}: its bytes differ from their digest")
    return read_curve(data)


def _bytes(path: Path) -> bytes:
    try:
        return read_bounded(path, TABLE)
    except FileNotFoundError as error:
        raise _damaged(path.parent, f"{path.name}: missing") from error
    except OSError as error:
        raise StoreError(f"cannot be read ({error.strerror})", where=path) from error


def _write(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _damaged(path: Path, what: str) -> DamagedTable:
    return DamagedTable(
        what, where=path, do="restore this version from a copy, or fit the table again"
    )
