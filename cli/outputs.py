"""Checks of ``--out`` before the work, so that its files can be written after it."""

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import typer

from cli.console import say

OUT = "--out"


def ready_folder(out: Path | None) -> None:
    """Refuse a file where a folder will be written; settle what a killed run left in the folder."""
    from calib.publish import settle

    if out is None:
        return
    if out.exists() and not out.is_dir():
        raise typer.BadParameter(f"{out} is a file", param_hint=OUT)
    with writing(out):
        settled = settle(out)
    if settled:
        say(f"settled what a run that was killed had left in {out}")


def refuse_folder(out: Path) -> None:
    """Refuse a folder, and a file in a missing folder, where a file will be written."""
    if out.is_dir():
        raise typer.BadParameter(f"cannot write {out}: it is a directory", param_hint=OUT)
    if not out.absolute().parent.is_dir():
        raise typer.BadParameter(f"cannot write {out}: no directory {out.parent}", param_hint=OUT)


def refuse_overwriting(
    outputs: Iterable[Path], logs: Sequence[Path], others: Iterable[Path | None] = ()
) -> None:
    """Refuse an output that is one of the inputs: a log, or one of the other files."""
    written = {os.path.realpath(path) for path in outputs}
    for path in (*logs, *others):
        if path is not None and os.path.realpath(path) in written:
            what = "the log " if path in logs else ""
            raise typer.BadParameter(f"would overwrite {what}{path}", param_hint=OUT)


def stems_of(logs: Iterable[Path], param_hint: str, called: str = "logs") -> list[str]:
    """Names of the logs without their endings; each is the name of a file in ``--out``."""
    from calib.logs.tables import stem_of

    stems = [stem_of(path) for path in logs]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        raise typer.BadParameter(
            f"two {called} are named {twice[0]}, and --out has one file per name",
            param_hint=param_hint,
        )
    return stems


@contextmanager
def writing(out: Path | None) -> Iterator[None]:
    """Turn an OSError within the context into a usage error that names ``out``.

    A BrokenPipeError, from a closed reader of stdout, is passed on.
    """
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        what = f"cannot be written ({error.strerror})"
        raise typer.BadParameter(
            what if out is None else f"{out} {what}", param_hint=OUT
        ) from error
