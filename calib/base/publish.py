"""Files of one run in a folder: no verdict stands beside files of another run.

    out/.making-<random>/    where a run makes its files; locked while that run is alive

The old verdict goes first and the new one comes last. A run that is killed leaves its folder, which
the next one deletes, and the old run, the new one, or no verdict.
"""

import errno
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath

from calib.base.write import locked_folder, sync

_WORK = ".making-"
"""How the name of a work folder begins."""


def _nothing(out: Path) -> Iterable[str]:
    return ()


@contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """Make a hidden work folder in ``out``; it is deleted afterwards.

    It is inside ``out``, because the parent folder may be on another file system. If ``out`` did
    not exist before and stays empty, it is deleted too. Raises OSError at once if ``out`` cannot be
    written.
    """
    made = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    try:
        clear(out)
        work = Path(tempfile.mkdtemp(prefix=_WORK, dir=out))
        with locked_folder(work):
            try:
                yield work
            finally:
                shutil.rmtree(work, ignore_errors=True)
    finally:
        if made:
            with suppress(OSError):
                out.rmdir()


def clear(out: Path) -> None:
    """Delete the work folders of killed runs in ``out``, but for those of other people."""
    for work in out.glob(f"{_WORK}*"):
        with suppress(BlockingIOError, PermissionError), locked_folder(work, wait=False):
            shutil.rmtree(work)


def publish(
    work: Path, out: Path, verdict: str, stale: Callable[[Path], Iterable[str]] = _nothing
) -> list[Path]:
    """Move everything from ``work``, made by `workshop`, into ``out``; return the paths.

    Parameters
    ----------
    verdict : name of the file in ``work`` that says what the others are; it is moved last.
    stale : gives the names of files of earlier runs in ``out``. Those that this run did not make
        again are removed; other files stay. Called while no other run is published there.

    Where a file cannot be moved, those that were moved are removed; the old verdict is gone then.
    Raises OSError.
    """
    files = (path for path in work.rglob("*") if not path.is_dir())
    names = sorted(path.relative_to(work).as_posix() for path in files)
    names = [*(name for name in names if name != verdict), verdict]
    refuse_obstacles(out, names)
    for path in work.rglob("*"):
        sync(path)
    with locked_folder(out):
        left = {name for name in stale(out) if _is_inside(out, name)} - {*names}
        _remove(out, [verdict])
        sync(out)
        _remove(out, left)
        try:
            _move(work, out, names)
        except BaseException:
            _remove(out, names)
            raise
    return [out / name for name in names]


def _move(work: Path, out: Path, names: list[str]) -> None:
    """Move files in this order; the last one when the others are on the disk."""
    for name in names:
        if name == names[-1]:
            for parent in {(out / other).parent for other in names}:
                sync(parent)
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        os.replace(work / name, out / name)
    sync(out)


def _is_inside(out: Path, name: str) -> bool:
    """Whether a name is a path that stays within the folder ``out``, also where links lead."""
    path = PurePosixPath(name)
    plain = bool(path.parts) and not path.is_absolute() and ".." not in path.parts
    return plain and (out / name).parent.resolve().is_relative_to(out.resolve())


def refuse_obstacles(out: Path, names: Iterable[str]) -> None:
    """Raise OSError if a folder is where a file of ``names`` goes, or a file where its folder."""
    for name in names:
        if (out / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(out / name))
        for folder in _folders(out, name):
            if folder.exists() and not folder.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _remove(out: Path, names: Iterable[str]) -> None:
    """Delete files, and the folders of theirs that are empty then."""
    for name in names:
        if not (out / name).is_dir():
            (out / name).unlink(missing_ok=True)
        for folder in _folders(out, name):
            with suppress(OSError):  # missing, or with other files
                folder.rmdir()


def _folders(out: Path, name: str) -> list[Path]:
    """Folders between ``out`` and the file ``name``, the inner ones first."""
    return [out / folder for folder in [*PurePosixPath(name).parents][:-1]]
