"""`--out`: one rule for all commands, checked before the work.

A folder is made with its parents; files of the same names in it are replaced, others stay. A file
is made with its parents; one that exists is replaced if it is empty or this program wrote it, and
anything else only with --force. No output ever replaces an input.
"""

import errno
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import typer

from calib.base.errors import AnswerError
from cli.console import say

OUT = "--out"
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
"""What a disk says that takes no more; nothing is wrong with the command line."""
PAGES = (".html", ".htm")
"""Endings of a page."""


def ready_folder(out: Path | None, names: Iterable[str] = ()) -> None:
    """Refuse a file where a folder will be written; settle what a killed run left in the folder.

    ``names`` of files that will be written there: a folder in the place of one is refused, too.
    """
    from calib.base.publish import refuse_obstacles, settle

    if out is None:
        return
    if out.exists() and not out.is_dir():
        raise typer.BadParameter(f"{out} is a file", param_hint=OUT)
    _refuse_parent(out)
    try:
        settled = settle(out)
        refuse_obstacles(out, names)
    except IsADirectoryError as error:
        raise typer.BadParameter(
            f"cannot write {error.filename}: it is a directory", param_hint=OUT
        ) from error
    except OSError as error:
        raise _unwritable(out, error) from error
    if settled:
        say(f"settled what a run that was killed had left in {out}")


def refuse_folder(out: Path, option: str = OUT) -> None:
    """Refuse a folder where a file will be written, and a place where nothing can be written."""
    if out.is_dir():
        raise typer.BadParameter(f"cannot write {out}: it is a directory", param_hint=option)
    _refuse_parent(out, option)


def refuse_ending(out: Path, endings: Sequence[str], option: str = OUT) -> None:
    """Refuse a file whose ending is none of ``endings``, which begin with a point."""
    if out.suffix.lower() not in endings:
        raise typer.BadParameter(f"{out} must end in {', '.join(endings)}", param_hint=option)


def refuse_no_picture(out: Path, force: bool, option: str = OUT) -> None:
    """Refuse what is no place for a picture: another ending, a folder, a foreign file."""
    from calib.show.sheet import ENDINGS, is_picture

    refuse_ending(out, ENDINGS, option)
    refuse_folder(out, option)
    refuse_foreign(out, is_picture, "a picture", force, option)


def refuse_no_page(out: Path, force: bool | None, option: str = OUT) -> None:
    """Refuse what is no place for a page of HTML, in the same way."""
    refuse_ending(out, PAGES, option)
    refuse_folder(out, option)
    refuse_foreign(out, _is_page, "a page of this program", force, option)


def _is_page(data: bytes) -> bool:
    from calib.show.html import is_page

    return is_page(data)


def _refuse_parent(out: Path, option: str = OUT) -> None:
    """Refuse a place below a file, or below a folder that cannot be written."""
    above = next(path for path in out.absolute().parents if path.exists())
    if not above.is_dir():
        raise typer.BadParameter(
            f"cannot write {out}: {os.path.relpath(above)} is a file, not a directory",
            param_hint=option,
        )
    if not os.access(above, os.W_OK):
        raise typer.BadParameter(
            f"cannot write {out}: no permission to write in {os.path.relpath(above)}",
            param_hint=option,
        )


def refuse_foreign(
    out: Path, ours: Callable[[bytes], bool], what: str, force: bool | None, option: str = OUT
) -> None:
    """Refuse to replace a file unless it is empty, ``ours`` by its bytes, or --force is given.

    ``what`` says what would be replaced without --force; ``force`` is None where there is no such
    option.
    """
    from calib.base.bounded import LOG, read_bounded

    if force:
        return
    try:
        data = read_bounded(out, LOG)
        mine = not data or ours(data)
    except FileNotFoundError:
        return
    except OSError:
        mine = False
    if not mine:
        do = "give another name" if force is None else "--force replaces it"
        raise typer.BadParameter(f"{out} exists and is not {what}; {do}", param_hint=option)


def refuse_overwriting(
    outputs: Iterable[Path],
    logs: Sequence[Path],
    others: Iterable[Path | None] = (),
    option: str = OUT,
) -> None:
    """Refuse an output that is one of the inputs: a log, or one of the other files."""
    written = {os.path.realpath(path) for path in outputs}
    for path in (*logs, *others):
        if path is not None and os.path.realpath(path) in written:
            what = "the log " if path in logs else ""
            raise typer.BadParameter(f"would overwrite {what}{path}", param_hint=option)


REPORT = "--report"


def refuse_report(
    report: Path | None, logs: Sequence[Path], others: Iterable[Path | None] = ()
) -> None:
    """Refuse a page of another ending, in a place that cannot be written, or of a foreign file."""
    if report is None:
        return
    refuse_overwriting([report], logs, others, REPORT)
    refuse_no_page(report, None, REPORT)


def write_report(report: Path, page: str) -> None:
    """Write a page and say so."""
    from calib.base.write import write_whole

    with writing(report, REPORT):
        write_whole(report, page.encode())
    say(f"wrote {report}")


def today() -> str:
    """The date on a page, UTC."""
    from datetime import UTC, datetime

    return datetime.now(UTC).date().isoformat()


def stems_of(logs: Iterable[Path], param_hint: str, called: str = "logs") -> list[str]:
    """Names of the logs without their endings; each is the name of a file in ``--out``."""
    from calib.logs.formats import stem_of

    stems = [stem_of(path) for path in logs]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        raise typer.BadParameter(
            f"two {called} are named {twice[0]}, and --out has one file per name",
            param_hint=param_hint,
        )
    return stems


@contextmanager
def writing(out: Path | None, option: str = OUT) -> Iterator[None]:
    """Make the folder that ``out`` is in; turn an OSError into a usage error that names ``out``.

    A folder that was made here and stays empty is removed. Raises AnswerError for a full disk.
    """
    made: list[Path] = []
    try:
        made = [] if out is None else _made(out.absolute().parent)
        yield
    except OSError as error:
        if error.errno in FULL:
            raise AnswerError(f"cannot be written ({error.strerror})", where=out) from error
        raise _unwritable(out, error, option) from error
    finally:
        with suppress(OSError):
            for folder in made:
                folder.rmdir()


def _made(folder: Path) -> list[Path]:
    """Make a folder with its parents; those that were not there before, the innermost first."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return missing


def _unwritable(out: Path | None, error: OSError, option: str = OUT) -> typer.BadParameter:
    what = f"cannot be written ({error.strerror})"
    return typer.BadParameter(what if out is None else f"{out} {what}", param_hint=option)
