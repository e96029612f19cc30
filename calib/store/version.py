"""A version of a table as a folder, with a record and one Parquet file for each curve or map.

    v0001/record.json           {id, version, digest, parents, files, states, record}
          difference.parquet    D(eta)
          paper.parquet         f1(eta), f2(eta)
          tyre.parquet          g(slip)
          map.parquet, level_map.parquet, draws.parquet

``digest`` is that of the table's content and does not depend on the file format. ``parents`` are
the logs of the fit. ``files`` has the SHA-256 of each Parquet file, so that a damaged file is not
parsed. ``states`` names the journal. ``record`` is the table's content without curves and maps.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.arrays import Array
from calib.base.bounded import TABLE, read_bounded
from calib.base.digest import content_digest, sha256
from calib.base.errors import DamagedTable, StoreError
from calib.base.viewable import Viewable
from calib.base.write import sync
from calib.logs.parquet import numbers, parquet_of, parquet_table
from calib.store.folders import RECORD
from calib.store.journal import CRLF_FLAW, JOURNAL
from calib.store.state import NOT_STORED, OUTSIDE, UNJUDGED, VersionState
from calib.table.maps import UNITS
from calib.table.table import COLUMNS, Table


@dataclass(frozen=True)
class Stored(Viewable):
    """A table as a version of a store."""

    table: Table
    name: str
    version: int
    digest: str
    path: Path  # its folder
    record_digest: str = ""  # SHA-256 of the record file
    state: VersionState = UNJUDGED
    existed: bool = False  # whether `Store.save` found the version instead of writing it

    def __repr__(self) -> str:
        return f"{self.id} in {self.path}\n{self.table!r}"

    @property
    def id(self) -> str:
        """name@version."""
        return f"{self.name}@{self.version}"

    @property
    def ramp_digests(self) -> set[str]:
        """The digests of the ramps that the table was fitted to."""
        return {log.digest for log in self.table.provenance.logs if log.role == "ramp"}

    @property
    def address(self) -> dict[str, object]:
        """Name, version, digest and path, with which every JSON document of a version begins."""
        keys = ("id", "name", "version", "digest", "path")
        return {key: getattr(self, key) for key in keys}


def table_in(table: Table | Stored) -> Table:
    """Return the table of a version, or the given table itself."""
    return table.table if isinstance(table, Stored) else table


def as_version(table: Table | Stored) -> Stored:
    """Return a table as version 0 without a store, or the given version itself."""
    if isinstance(table, Stored):
        return table
    return Stored(table, table.name, 0, table.digest, Path(), state=NOT_STORED)


def write_version(table: Table, version: int, path: Path) -> None:
    """Write the files of a version into the new directory ``path``. Raises OSError."""
    record, curves = table.content()
    files = {f"{name}.parquet": _curve_bytes(columns) for name, columns in curves.items()}
    digests = {name: sha256(data) for name, data in files.items()}
    times = [log.sample_time for log in table.provenance.logs]
    files[RECORD] = _record_bytes(record, table.digest, version, digests, times)
    path.mkdir(parents=True)
    for name, data in files.items():
        (path / name).write_bytes(data)
        sync(path / name)
    sync(path)


def read_version(path: Path, expected_id: str | None = None) -> Stored:
    """Read a version; check its digests and ``expected_id``. Raises DamagedTable, StoreError."""
    from calib.base.record import validated  # pydantic is slow
    from calib.store.record_file import RecordFile, table_of

    def damaged(flaw: str) -> DamagedTable:
        return DamagedTable(f"{RECORD}: {flaw}", where=path)

    data = _bytes(path / RECORD)
    if b"\r\n" in data:
        raise damaged(CRLF_FLAW)
    try:
        file = validated(data, RecordFile, None, StoreError)
        record = json.loads(data)["record"]
    except (StoreError, RecursionError) as error:
        raise damaged(str(error)) from error
    try:
        curves = {name: _read_curve(path / f"{name}.parquet", file.files) for name in COLUMNS}
        if content_digest(record, curves) != file.digest:
            raise damaged("the record or its digest was changed")
        times = [parent.sample_time for parent in file.parents]
        table = table_of(file.record, curves, times)
    except (KeyError, TypeError, ValueError) as error:
        raise damaged(f"not the record of these curves ({error!r})") from error
    if data != _record_bytes(record, file.digest, file.version, file.files, times):
        raise damaged("its keys, their order or its spelling were edited")
    stored = Stored(table, table.name, file.version, file.digest, path, sha256(data), OUTSIDE)
    if expected_id not in (None, stored.id):
        raise damaged(f"holds {stored.id} in the place of {expected_id}")
    return stored


def _read_curve(path: Path, digests: dict[str, str]) -> dict[str, Array]:
    """Read the columns of a curve, each (n,); ``digests`` has the SHA-256 of the file by name."""
    data = _bytes(path)
    if sha256(data) != digests[path.name]:
        raise DamagedTable(f"{path.name}: its bytes differ from their digest", where=path.parent)
    curve = parquet_table(data)
    return {name: numbers(curve[name]) for name in curve.column_names}


def _curve_bytes(columns: dict[str, Array]) -> bytes:
    doubles = {name: np.asarray(column, np.float64) for name, column in columns.items()}
    units = {name: UNITS.get(name, "1") for name in columns}
    return parquet_of(doubles, units, compression="none", use_dictionary=False)


def _record_bytes(
    record: Any, digest: str, version: int, files: dict[str, str], sample_times: list[float | None]
) -> bytes:
    """Return the content of a record file.

    ``files`` has the SHA-256 of each curve's file, ``sample_times`` the time step of each log [s].
    """
    parents = []
    for log, time in zip(record["provenance"]["logs"], sample_times, strict=True):
        parent = {"name": log["name"], "digest": log["digest"]}
        if time:
            parent["sample_time"] = time
        parents.append(parent)
    document = {
        "id": f"{record['name']}@{version}",
        "version": version,
        "digest": digest,
        "parents": parents,
        "files": files,
        "record": record,
        "states": JOURNAL,
    }
    return (json.dumps(document, indent=2, sort_keys=True) + "\n").encode()


def _bytes(path: Path) -> bytes:
    try:
        return read_bounded(path, TABLE)
    except FileNotFoundError as error:
        raise DamagedTable(f"{path.name}: missing", where=path.parent) from error
    except OSError as error:
        raise StoreError(f"cannot be read ({error.strerror})", where=path) from error
