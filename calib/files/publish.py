"""Files of one run in a folder: all of them or none, whatever is killed when.

    out/.making-<random>/       where a run makes its files
    out/.making-<random>.lock   locked while that run is alive
    out/.publishing.json        what the run that is published now does to out, `calib.files.intent`
    out/.publishing.lock        locked by the one process that changes out

All of these are gone after a run. What a killed run left is settled by the next one.
"""

import secrets
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from calib.files.intent import (
    WORK,
    Intent,
    is_inside,
    perform,
    read_intent,
    refuse_obstacles,
    undo,
    write_intent,
)
from calib.files.write import locked, sync

LOCK = ".publishing.lock"


def _nothing(out: Path) -> Iterable[str]:
    return ()


@contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """Make a hidden work folder in ``out``; it is deleted afterwards.

    It is inside ``out``, because the parent folder may be on another file system. What a killed run
    left is settled first. If ``out`` did not exist before and stays empty, it is deleted too.
    Raises OSError at once if ``out`` cannot be written.
    """
    made = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with _work_folder(out) as work:
            yield work
    finally:
        if made:
            with suppress(OSError):
                out.rmdir()


def publish(
    work: Path, out: Path, verdict: str, stale: Callable[[Path], Iterable[str]] = _nothing
) -> list[Path]:
    """Move everything from ``work``, made by `workshop`, into ``out``; return the paths.

    Parameters
    ----------
    verdict : name of the file in ``work`` that says what the others are; it is moved last.
    stale : gives the names of files of earlier runs in ``out``. Those that this run did not make
        again are removed; other files stay. Called while no other process can change ``out``.

    Where a file cannot be moved, those that were moved are removed; the old verdict is gone then.
    Raises OSError.
    """
    found = (path.relative_to(work).as_posix() for path in work.rglob("*") if not path.is_dir())
    names = tuple(sorted(found, key=lambda name: (name == verdict, name)))
    with _alone(out):
        _finish(out)
        refuse_obstacles(out, names)
        left = {name for name in stale(out) if is_inside(name)} - {*names}
        intent = Intent(work.name, tuple(sorted(left)), names)
        _sync_all(work)
        write_intent(out, intent)
        try:
            perform(out, intent)
        except BaseException:
            with suppress(OSError):
                undo(out, intent)
            raise
    return [out / name for name in names]


def settle(out: Path) -> bool:
    """Finish or clear what killed runs left in ``out``; return whether there was anything.

    The work of a run that is alive is not touched. Raises OSError if ``out`` cannot be written.
    """
    if not any((*out.glob(f"{WORK}*"), *out.glob(".publishing.*"))):
        return False
    with _alone(out):
        return _settle(out)


@contextmanager
def _alone(out: Path) -> Iterator[None]:
    """No other process changes ``out`` within this context."""
    with locked(out / LOCK):
        try:
            yield
        finally:
            (out / LOCK).unlink(missing_ok=True)


@contextmanager
def _work_folder(out: Path) -> Iterator[Path]:
    """A new work folder, locked as long as this process has it."""
    work = out / f"{WORK}{secrets.token_hex(8)}"
    with ExitStack() as owned:
        with _alone(out):
            _settle(out)
            owned.enter_context(locked(_lock_of(work)))
            try:
                work.mkdir()
            except BaseException:
                _lock_of(work).unlink()
                raise
        try:
            yield work
        finally:
            _delete(work)


def _settle(out: Path) -> bool:
    finished = _finish(out)
    works = {path.name.removesuffix(".lock") for path in out.glob(f"{WORK}*")}
    cleared = [name for name in sorted(works) if _cleared(out / name)]
    return finished or bool(cleared)


def _finish(out: Path) -> bool:
    """Do what a killed run intended; return whether there was an intent."""
    intent = read_intent(out)
    if intent is not None:
        perform(out, intent)
    return intent is not None


def _cleared(work: Path) -> bool:
    """Delete a work folder unless its run is alive or another person's; whether it was deleted."""
    try:
        with locked(_lock_of(work), wait=False):
            _delete(work)
    except (BlockingIOError, PermissionError):
        return False
    return True


def _delete(work: Path) -> None:
    shutil.rmtree(work, ignore_errors=True)
    _lock_of(work).unlink(missing_ok=True)


def _lock_of(work: Path) -> Path:
    return work.with_name(f"{work.name}.lock")


def _sync_all(work: Path) -> None:
    """Wait until all files below ``work``, and their names, are on the disk."""
    for path in (work, *work.rglob("*")):
        sync(path)
