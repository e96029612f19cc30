"""Tables on disk: versions that are written once, never edited, and verified on load.

    tables/                       the store
      sedan/                      a table, named after its vehicle
        v0001/                    a version, see `calib.table.version`

A version is made in a hidden directory beside it and then renamed, so a reader gets all of it or
nothing, and of two writers one takes the next number.
"""

import contextlib
import errno
import os
import re
import secrets
import shutil
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from calib.errors import StoreError, TableNotFound
from calib.table.invariants import violations
from calib.table.table import Table
from calib.table.version import (
    RECORD,
    Stored,
    read_version,
    stored_content,
    sync_directory,
    write_curves,
    write_record,
)

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")
FOLDER = re.compile(r"v(\d{4,6})")


@dataclass(frozen=True)
class StoreEntry:
    """One version in a listing; ``digest`` is None and ``logs`` empty where it cannot be read."""

    name: str
    version: int
    digest: str | None
    logs: tuple[str, ...]
    path: Path

    @property
    def id(self) -> str:
        """name@version."""
        return f"{self.name}@{self.version}"


@dataclass(frozen=True)
class StoreVerdict:
    """Result of `verify` for one version: its violations in words, none when it is sound."""

    id: str
    violations: tuple[str, ...]

    @property
    def sound(self) -> bool:
        """Whether there are no violations."""
        return not self.violations


class Store:
    """A folder of tables; ``folder`` is its path, and is made by the first `save`.

    >>> import tempfile
    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     store = calib.Store(folder)
    ...     again = [store.save(table).id for _ in range(2)]  # one content is one version
    ...     loaded = store.load("sedan-sim").table
    ...     sound = [verdict.sound for verdict in store.verify()]
    >>> again, sound, loaded.digest == table.digest
    (['sedan-sim@1', 'sedan-sim@1'], [True], True)
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)

    def __repr__(self) -> str:
        return f"Store({str(self.folder)!r})"

    def save(self, table: Table) -> Stored:
        """Write ``table`` as the next version of its name, or return the one that holds it already.

        Raises StoreError when the name is not valid, the table is not sound or the store cannot be
        written; the store is then not changed.
        """
        home = self._home(table)
        work = home / f".new-{secrets.token_hex(8)}"  # hidden: no listing shows it
        try:
            version = _identical(home, _versions(home), table.digest) or _add(table, home, work)
        except OSError as error:
            raise StoreError(
                f"cannot be written ({error.strerror})", where=self.folder, do="nothing was stored"
            ) from error
        finally:
            shutil.rmtree(work, ignore_errors=True)
            with contextlib.suppress(OSError):
                home.rmdir()  # only when this call made it and put nothing there
        return self.load(f"{table.name}@{version}")

    def foreseen(self, table: Table) -> Stored:
        """What `save` will return if no other writer adds a version before; writes nothing.

        Raises StoreError when the name is not valid, the table is not sound or the store cannot be
        read.
        """
        from calib.table.record_file import from_content

        home = self._home(table)
        try:
            versions = _versions(home)
        except OSError as error:
            raise StoreError(f"cannot be read ({error.strerror})", where=self.folder) from error
        version = _identical(home, versions, table.digest) or max(versions, default=0) + 1
        record, curves = table.content()
        read = from_content(record, curves)
        return Stored(read, table.name, version, table.digest, home / _folder(version))

    def load(self, reference: str) -> Stored:
        """Read and verify a table: ``name`` (its latest), ``name@version`` or a path to a version.

        Raises TableNotFound when there is none, DamagedTable when it does not agree with its
        digests.
        """
        path = _path_of(reference)
        if path is not None:
            return read_version(path)
        name, at, version = reference.partition("@")
        home = self.folder / self._known_name(name)
        versions = _versions(home)
        if not at:
            return read_version(home / _folder(max(versions)), f"{name}@{max(versions)}")
        if not version.isdecimal() or int(version) not in versions:
            raise TableNotFound(
                f"no version {version!r} of {name!r}",
                where=self.folder,
                expected="one of " + ", ".join(map(str, versions)),
            )
        return read_version(home / _folder(int(version)), f"{name}@{int(version)}")

    def list(self) -> tuple[StoreEntry, ...]:
        """Every version in the store, by name and version, without verifying any of them.

        Raises TableNotFound when there is no store, StoreError when it cannot be read.
        """
        homes = [self.folder / name for name in self._names()]
        return tuple(
            _entry(home.name, version, home / _folder(version))
            for home in homes
            for version in _versions(home)
        )

    def verify(self, name: str | None = None) -> tuple[StoreVerdict, ...]:
        """Recompute digests and invariants, of one table or of all.

        One verdict per version, and one per missing version. Raises TableNotFound when there is no
        store, or no table of that name.
        """
        names = self._names() if name is None else (self._known_name(name),)
        return tuple(
            StoreVerdict(f"{name}@{version}", _version_flaws(self.folder / name, name, version))
            for name in names
            for version in range(1, max(_versions(self.folder / name)) + 1)
        )

    def _home(self, table: Table) -> Path:
        """Directory of the versions of ``table``. Raises StoreError if it may not be stored."""
        home = self.folder / _checked_name(table.name)
        if found := violations(table):
            raise StoreError(
                f"the table is not sound and was not stored: {'; '.join(found)}",
                where=table.name,
                expected="a table that `brake-cal tables verify` passes",
            )
        return home

    def _known_name(self, name: str) -> str:
        """Return ``name`` if the store has a table of that name. Raises TableNotFound."""
        known = self._names()
        if _checked_name(name) in known:
            return name
        near = get_close_matches(name, known, n=1)
        raise TableNotFound(
            f"no table {name!r}",
            where=self.folder,
            expected="one of " + ", ".join(known) if known else "a table: the store is empty",
            do=f"did you mean {near[0]!r}?" if near else "",
        )

    def _names(self) -> tuple[str, ...]:
        """Names of the tables, in order. Raises TableNotFound where there is no store."""
        if not self.folder.is_dir():
            raise TableNotFound(
                "no table store here",
                where=self.folder,
                do="`brake-cal fit` makes one, --store names another",
            )
        try:
            homes = (p for p in self.folder.iterdir() if NAME.fullmatch(p.name) and _versions(p))
            return tuple(sorted(p.name for p in homes))
        except OSError as error:
            raise StoreError(f"cannot be read ({error.strerror})", where=self.folder) from error


def _version_flaws(home: Path, name: str, version: int) -> tuple[str, ...]:
    path = home / _folder(version)
    if not path.is_dir():
        return ("missing: a later version is there, this one is not",)
    try:
        return violations(read_version(path, f"{name}@{version}").table)
    except StoreError as error:
        return (error.what,)


def _checked_name(name: str) -> str:
    """Return ``name`` if it is a valid name of a table, which is always a folder of the store."""
    if not NAME.fullmatch(name) or ".." in name:
        raise StoreError(
            f"{name!r} cannot name a table",
            expected="letters, digits and . _ - only, at most 100, a letter or digit first",
        )
    return name


def _folder(version: int) -> str:
    return f"v{version:04d}"


def _versions(home: Path) -> list[int]:
    """Version numbers in a table's directory, ascending; empty without the directory."""
    if not home.is_dir():
        return []
    found = [(p, FOLDER.fullmatch(p.name)) for p in home.iterdir()]
    numbers = [int(match[1]) for p, match in found if match and p.is_dir()]
    return sorted(n for n in numbers if n > 0 and (home / _folder(n)).is_dir())


def _path_of(reference: str) -> Path | None:
    """Directory of the version that ``reference`` names as a path; None when it is not a path."""
    path = Path(reference)
    if path.name == RECORD:
        path = path.parent
    elif os.sep not in reference and not (path / RECORD).is_file():
        return None
    if not path.is_dir():
        raise TableNotFound(
            "no such directory", where=reference, expected="name, name@version or path"
        )
    if not (path / RECORD).is_file() and not any(path.glob("*.parquet")):
        raise TableNotFound(
            f"no {RECORD} in it",
            where=reference,
            expected="the directory of one version, like v0001",
        )
    return path


def _add(table: Table, home: Path, work: Path) -> int:
    """Write the files under ``work`` and rename it to the next free version, which is returned."""
    work.mkdir(parents=True)
    write_curves(table, work)
    while True:
        # One listing for both decisions: if another writer adds a version after it, the rename
        # fails, and the next round has the new version.
        versions = _versions(home)
        if (same := _identical(home, versions, table.digest)) is not None:
            return same
        version = max(versions, default=0) + 1
        write_record(table, version, work)
        try:
            # A rename never replaces a directory with files in it: it fails if the number is taken.
            os.rename(work, home / _folder(version))
        except OSError as error:
            if error.errno not in (errno.EEXIST, errno.ENOTEMPTY):
                raise
        else:
            sync_directory(home)
            return version


def _identical(home: Path, versions: list[int], digest: str) -> int | None:
    """Version that already holds the content ``digest``, None if there is none.

    A version that cannot be read is skipped: `verify` reports it, and it does not prevent a save.
    """
    for version in reversed(versions):
        if _entry(home.name, version, home / _folder(version)).digest == digest:
            return version
    return None


def _entry(name: str, version: int, path: Path) -> StoreEntry:
    try:
        digest, logs = stored_content(path)
    except StoreError:
        return StoreEntry(name, version, None, (), path)
    return StoreEntry(name, version, digest, logs, path)
