"""Outputs: one rule for all commands, checked before the work.

Folders are made; of one that exists, files of the same names are replaced. A file is replaced if it
is empty or this program wrote it, else only with --force. No output replaces an input.
"""

import errno
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from calib.base.errors import AnswerError
from cli.console import misuse, say, this_run

OUT = "--out"
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
"""Errors of the disk (full, quota, file too large, input or output), not of the command line."""
PAGES = (".html", ".htm")
EITHER = "either"
"""Kind of an output that is a file or a folder, by other options."""


def check_file(out: Path, kind: str = "", option: str = OUT) -> None:
    """Refuse a place where no file of a kind can be written, an input, and a foreign file."""
    from calib.logs.write import WRITERS
    from calib.show.sheet import ENDINGS

    endings = {
        "picture": ENDINGS,
        "drawing": (*ENDINGS, *PAGES),
        "page": PAGES,
        "log": (*ENDINGS, *PAGES, *WRITERS),
        "simulation": (".csv", ".parquet"),
    }.get(kind, ())
    if endings and out.suffix.lower() not in endings:
        raise misuse(f"{out} must end in {', '.join(endings)}", option)
    if out.is_dir() and kind != EITHER:
        raise misuse(f"cannot write {out}: it is a directory", option)
    _refuse_parent(out, option)
    _refuse_inputs([out], option)
    if ours := _ours(out, kind):
        refuse_foreign(out, ours, option)


def _ours(out: Path, kind: str = "") -> Callable[[bytes], bool] | None:
    """Test whether this program wrote the bytes; None where only equal ones may be replaced."""
    from calib.show.html import is_page
    from calib.show.sheet import ENDINGS, is_picture

    by_kind = {"simulation": lambda data: b"true_" in data, "map": _is_sealed}
    by_ending = dict.fromkeys(PAGES, is_page) | dict.fromkeys(ENDINGS, is_picture)
    return by_ending.get(out.suffix.lower()) or by_kind.get(kind)


_SEAL = "# unedited: "


def sealed(text: str) -> bytes:
    """A text that people edit, with a line by which it is known as long as nobody did."""
    from calib.base.digest import sha256

    return f"{text}{_SEAL}{sha256(text.encode())[:16]}\n".encode()


def _is_sealed(data: bytes) -> bool:
    text, seal, _ = data.decode(errors="replace").rpartition(_SEAL)
    return bool(seal) and sealed(text) == data


def check_folder(out: Path | None, names: Iterable[str]) -> None:
    """Refuse a folder that is a file, or in which one of the ``names`` is an input or a folder."""
    from calib.base.write import refuse_obstacles

    if out is None:
        return
    names = list(names)
    if out.exists() and not out.is_dir():
        raise misuse(f"{out} is a file", OUT)
    _refuse_parent(out, OUT)
    _refuse_inputs([out / name for name in names], OUT)
    try:
        refuse_obstacles(out, names)
    except OSError as error:
        raise misuse(f"{error.filename or out} {_unwritable(error)}", OUT) from error


def refuse_foreign(out: Path, ours: Callable[[bytes], bool], option: str = OUT) -> None:
    """Refuse to replace a file unless it is empty, ``ours`` by its bytes, or --force is given."""
    from calib.base.bounded import LOG, read_bounded

    try:
        data = read_bounded(out, LOG)
        may_replace = not data or ours(data)
    except OSError as error:
        may_replace = isinstance(error, FileNotFoundError)
    if not (may_replace or this_run().force):
        raise misuse(f"{out} exists and is not what is written here; --force replaces it", option)


def write_file(out: Path, content: bytes, option: str = OUT, kind: str = "") -> None:
    """Write a file whole. Where only equal bytes count as ours, they are compared here."""
    from calib.base.write import write_whole

    if _ours(out, kind) is None:
        refuse_foreign(out, content.__eq__, option)
    with writing(out, option):
        write_whole(out, content)
    say(f"wrote {out}")


def write_page(out: Path, result: object, option: str = OUT) -> None:
    """Write a result or its facts as a page, with live pictures where Bokeh is installed."""
    from calib.show.facts import facts_of
    from calib.show.html import page_of
    from calib.show.interactive import EXTRA, installed

    page = page_of(facts_of(result), live=installed())
    if "<figure>" in page and not installed():
        say(f"the pictures stand still; to zoom in them: pip install 'brake-cal[{EXTRA}]'")
    write_file(out, page.encode(), option)


def write_folder(out: Path, contents: Iterable[tuple[str, bytes]], last: str) -> None:
    """Write all files into a folder, or none; ``last`` is published after all others."""
    from calib.base.write import publish, work_folder, write_whole

    with writing(out), work_folder(out) as work:
        for name, content in contents:
            write_whole(work / name, content)
        paths = publish(work, out, last)
    say(f"wrote {out}: {', '.join(path.name for path in paths)}")


def stems_of(logs: Iterable[Path], option: str) -> list[str]:
    """Names of the logs without their endings; each is the name of a file in ``--out``."""
    from calib.logs.formats import stem_of

    stems = [stem_of(path) for path in logs]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        raise misuse(f"two logs are named {twice[0]}, and --out has one file per name", option)
    return stems


@contextmanager
def writing(out: Path | None, option: str = OUT) -> Iterator[None]:
    """Make the folder that ``out`` is in; turn an OSError into a usage error that names ``out``.

    A folder that was made here and stays empty is removed. Raises AnswerError for a full disk.
    """
    folders: list[Path] = []
    try:
        if out is not None:
            above = out.absolute().parent
            folders = [path for path in (above, *above.parents) if not path.exists()]
            above.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        why = _unwritable(error)
        if error.errno in FULL:
            raise AnswerError(why, where=out) from error
        raise misuse(why if out is None else f"{out} {why}", option) from error
    finally:
        with suppress(OSError):
            for folder in folders:
                folder.rmdir()


def _refuse_parent(out: Path, option: str) -> None:
    """Refuse a place below a file, or below a folder that cannot be written."""
    above = next(path for path in out.absolute().parents if path.exists())
    if not above.is_dir():
        raise misuse(f"cannot write {out}: {above} is a file, not a directory", option)
    if not os.access(above, os.W_OK):
        raise misuse(f"cannot write {out}: no permission to write in {above}", option)


def _refuse_inputs(outputs: Iterable[Path], option: str) -> None:
    written = {os.path.realpath(path) for path in outputs}
    for path in (one for given in this_run().inputs.values() for one in given):
        if os.path.realpath(path) in written:
            raise misuse(f"would overwrite {path}", option)


def _unwritable(error: OSError) -> str:
    return f"cannot be written ({error.strerror})"
