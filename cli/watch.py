"""`brake-cal watch`: one command on every new log in a folder."""

import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Annotated, Any

import typer

from calib.line.fleet.rows import Command
from cli.console import complain, emit_line, json_line, say
from cli.jobs import Commands, Fresh, JobOptions, Out
from cli.options import Workers, example, grouped
from cli.outputs import writing

if TYPE_CHECKING:
    from calib.line.fleet.rows import Row

EPILOG = example("brake-cal watch check sample_logs/sedan --out watched")


@grouped
def watch(
    command: Commands,
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder of logs.", exists=True, file_okay=False)
    ],
    *,
    out: Out,
    workers: Workers = None,
    options: JobOptions,
    fresh: Fresh = False,
    every: Annotated[float, typer.Option(metavar="S", min=0.05, help="Seconds between scans.")] = 1,
    settle: Annotated[
        float, typer.Option(metavar="S", min=0.0, help="Seconds unchanged until a log is complete.")
    ] = 2,
    index: Annotated[
        Path | None,
        typer.Option(
            "--index",
            metavar="RUNS",
            help="Keep the index of these station runs up to date.",
            exists=True,
            file_okay=False,
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="One line of JSON per log.")] = False,
) -> None:
    """Process each log that appears in a folder, until stopped.

    Ctrl-C or SIGTERM stop it. A second signal ends it at once. Prints a line per log, after its row
    is on the disk. Rows are kept as by `batch`, named by their path within DIR: a watch that was
    stopped or killed continues where it was; a log that changes is processed again; one that is
    deleted keeps its row. Exit code 0.
    """
    if command is Command.DIAGNOSE:
        raise typer.BadParameter("diagnose takes folders: use `brake-cal batch`")
    job = options.job(command, out)
    from calib.base.processes import cores
    from calib.line.fleet.watch import watch as watch_folder
    from calib.line.fleet.workers import Pool

    pool = Pool(workers or cores())
    show = _teller(command, json)
    try:
        with writing(out), _stopped() as stop:
            say(f"watching {folder} for logs to {command.value}; Ctrl-C ends it")
            done = watch_folder(
                job,
                folder,
                out,
                pool,
                stop,
                show,
                complain,
                every=every,
                settle=settle,
                fresh=fresh,
                each=_indexer(index),
            )
    finally:
        pool.close()
    counts = ", ".join(f"{n} {status}" for status, n in sorted(done.counts.items()))
    say(f"{counts}; {done.results}" if done.results else "no log came")


def _indexer(runs: Path | None) -> Callable[[], None]:
    """The function that is called after each scan: it writes the index, if there is one.

    A disk that is full for a while must not end the watch: the next scan tries again.
    """
    if runs is None:
        return lambda: None
    from calib.show.station_index import write_index

    troubled = False

    def write() -> None:
        nonlocal troubled
        try:
            write_index(runs)
        except OSError as error:
            if not troubled:
                complain(f"{runs}: the index cannot be written ({error.strerror})")
            troubled = True
        else:
            troubled = False

    return write


@contextmanager
def _stopped() -> Iterator[Event]:
    """An event that Ctrl-C and SIGTERM set; logs in work are finished. A second signal kills."""
    stop = Event()
    handlers: dict[signal.Signals, Any] = {}

    def restore() -> None:
        for number, handler in handlers.items():
            signal.signal(number, handler or signal.SIG_DFL)

    def end(number: int, frame: object) -> None:
        stop.set()
        restore()

    for number in (signal.SIGINT, signal.SIGTERM):
        handlers[number] = signal.signal(number, end)
    try:
        yield stop
    finally:
        restore()


def _teller(command: Command, json: bool) -> "Callable[[Row], None]":
    """The function that prints a row: its status and error, and the pads where it has them."""
    from calib.line.fleet.rows import columns_of

    names = [column.name for column in columns_of(command)]

    def show(row: "Row") -> None:
        metrics = dict(zip(names, row.cells, strict=False))
        if json:
            head = {"log": row.log, "digest": row.digest, "status": row.status, "error": row.error}
            emit_line(json_line({**head, "figures": metrics}))
        elif row.error is not None:
            emit_line(f"{row.log}: error: {row.error.removeprefix(f'{row.log}: ')}")
        else:
            broken = f" ({metrics['not_held']})" if metrics.get("not_held") else ""
            emit_line(f"{row.log}: {row.status}{broken}{_pads(metrics)}")

    return show


def _pads(metrics: Mapping[str, object]) -> str:
    front, rear = metrics.get("pad_friction_f"), metrics.get("pad_friction_r")
    if isinstance(front, float) and isinstance(rear, float):
        return f", pads {front:.3f} / {rear:.3f}"
    return ""
