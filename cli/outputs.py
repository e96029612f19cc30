"""Check and write the files and folders of the commands, all by the same rules.

A folder is made if it does not exist, and files of the same names in it are replaced. A single file
is replaced if it is empty or if this program wrote it, any other file only with --force. No output
replaces an input. The commands check this before they begin to work.
"""

import errno
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from itertools import chain
from pathlib import Path

from calib.base.errors import AnswerError
from cli.console import say, this_run, usage_error

OUT = "--out"
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # the last: the device fails
PAGES = (".html", ".htm")
EITHER = "either"  # kind of an output that is a file or a folder; another option says which


def check_file(out: Path, kind: str = "", option: str = OUT) -> None:
    """Refuse a place that cannot be written, an input, and a file that this program did not write.

    ``kind`` says which endings are possible, "" allows any. ``out`` was typed at ``option``.
    """
    from calib.logs.write import WRITERS
    from calib.show.sheet import ENDINGS

    endings = {
        "picture": ENDINGS,
        "drawing": (*ENDINGS, *PAGES),
        "page": PAGES,
        "log": (*ENDINGS, *PAGES, *WRITERS),  # drawn, as a page, or as a log
        "simulation": (".csv", ".parquet"),
    }.get(kind, ())
    if endings and out.suffix.lower() not in endings:
        raise usage_error(f"{out} must end in {', '.join(endings)}", option)
    if out.is_dir() and kind != EITHER:
        raise usage_error(f"cannot write {out}: it is a folder; expected a file", option)
    _refuse_place(out, [out], option)
    is_ours = _test_of_ours(out, kind)
    if is_ours is not None:
        refuse_foreign(out, is_ours, option)


def _test_of_ours(out: Path, kind: str = "") -> Callable[[bytes], bool] | None:
    """Return the test whether bytes were written by this program, None if there is no such test."""
    from calib.show.html import is_page
    from calib.show.sheet import ENDINGS, is_picture

    # a simulated log has columns of true values, named true_...
    by_kind = {"simulation": lambda data: b"true_" in data, "map": _is_sealed}
    by_ending = dict.fromkeys(PAGES, is_page) | dict.fromkeys(ENDINGS, is_picture)
    return by_ending.get(out.suffix.lower()) or by_kind.get(kind)


_SEAL = "# unedited: "


def sealed(text: str) -> bytes:
    """Return a text with a last line that shows whether somebody has edited it since."""
    from calib.base.digest import sha256

    return f"{text}{_SEAL}{sha256(text.encode())[:16]}\n".encode()


def _is_sealed(data: bytes) -> bool:
    text, seal, _ = data.decode(errors="replace").rpartition(_SEAL)
    return bool(seal) and sealed(text) == data


def check_folder(out: Path | None, names: Iterable[str]) -> None:
    """Refuse a folder in which a file of ``names`` cannot be written, or is an input."""
    from calib.base.write import refuse_obstacles

    if out is None:
        return
    names = list(names)
    if out.exists() and not out.is_dir():
        raise usage_error(f"{out} is a file; expected a folder", OUT)
    _refuse_place(out, [out / name for name in names], OUT)
    try:
        refuse_obstacles(out, names)
    except OSError as error:
        raise usage_error(f"{error.filename or out} {_unwritable(error)}", OUT) from error


def refuse_foreign(out: Path, is_ours: Callable[[bytes], bool], option: str = OUT) -> None:
    """Refuse to replace a file unless it is empty, passes ``is_ours``, or --force was typed."""
    from calib.base.bounded import LOG, read_bounded

    try:
        data = read_bounded(out, LOG)
        may_replace = not data or is_ours(data)
    except OSError as error:
        may_replace = isinstance(error, FileNotFoundError)
    if not (may_replace or this_run().force):
        flaw = f"{out} exists and holds something else"
        raise usage_error(f"{flaw}; give another name, or replace it with --force", option)


def write_file(out: Path, content: bytes, option: str = OUT, kind: str = "") -> None:
    """Write a file. Where `_test_of_ours` has no test, only a file of equal bytes is replaced."""
    from calib.base.write import write_whole

    if _test_of_ours(out, kind) is None:
        refuse_foreign(out, lambda data: data == content, option)
    with writing(out, option):
        write_whole(out, content)
    say(f"wrote {out}")


def write_page(out: Path, result: object, option: str = OUT) -> None:
    """Write a result or its facts as a page, with interactive pictures where Bokeh is installed."""
    from calib.show.facts import facts_of
    from calib.show.html import page_of
    from calib.show.interactive import EXTRA, installed

    page = page_of(facts_of(result), live=installed())
    if "<figure>" in page and not installed():
        say(f"pictures cannot be zoomed without: pip install 'brake-cal[{EXTRA}]'")
    write_file(out, page.encode(), option)


def write_folder(out: Path, contents: Iterable[tuple[str, bytes]], last: str) -> None:
    """Write all files, each a name and its bytes, or none; the file ``last`` is moved last."""
    from calib.base.write import publish, work_folder, write_whole

    with writing(out), work_folder(out) as work:
        for name, content in contents:
            write_whole(work / name, content)
        paths = publish(work, out, last)
    say(f"wrote {out}: {', '.join(path.name for path in paths)}")


def stems_of(logs: Iterable[Path], option: str) -> list[str]:
    """Return the names of logs without their endings. Refuses two logs of the same name."""
    from calib.logs.formats import stem_of

    stems = [stem_of(path) for path in logs]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        raise usage_error(f"two logs are named {twice[0]}; rename one of them", option)
    return stems


@contextmanager
def writing(out: Path | None, option: str = OUT) -> Iterator[None]:
    """Make the folder that ``out`` is in, and remove it if it is empty at the end.

    An OSError within the context becomes an AnswerError for a full disk, else a usage error.
    """
    folders: list[Path] = []
    try:
        if out is not None:
            parent = out.absolute().parent
            folders = [path for path in (parent, *parent.parents) if not path.exists()]
            parent.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        why = _unwritable(error)
        if error.errno in FULL:
            raise AnswerError(why, where=out) from error
        raise usage_error(why if out is None else f"{out} {why}", option) from error
    finally:
        with suppress(OSError):
            for folder in folders:
                folder.rmdir()


def _refuse_place(out: Path, files: Iterable[Path], option: str) -> None:
    """Refuse ``out`` below a file or a read-only folder, and ``files`` that replace an input."""
    folder = next(path for path in out.absolute().parents if path.exists())
    if not folder.is_dir():
        raise usage_error(f"cannot write {out}: {folder} is a file, not a folder", option)
    if not os.access(folder, os.W_OK):
        raise usage_error(f"cannot write {out}: no permission to write in {folder}", option)
    written = {os.path.realpath(path) for path in files}
    for path in chain.from_iterable(this_run().inputs.values()):
        if os.path.realpath(path) in written:
            raise usage_error(f"would replace {path}, which is read", option)


def _unwritable(error: OSError) -> str:
    return f"cannot be written ({error.strerror})"
