"""`brake-cal batch`: one command on many logs, one row per log."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

from calib.base.plain import counted
from cli.console import emit, emit_json, is_watched, progress_bar, say
from cli.jobs import Commands, Fresh, JobOptions, Out
from cli.options import Json, Workers, example, grouped
from cli.outputs import writing
from cli.stop import stoppable

if TYPE_CHECKING:
    from calib.line.fleet.batch import Batch, Pace
    from calib.line.fleet.workers import Executor

EPILOG = example(
    "brake-cal batch check sample_logs/sedan --out checked",
    "brake-cal batch validate 'sample_logs/sedan/*pads.csv' --table sedan-2up --out validated",
)
FAILED, UNREADABLE = 1, 3


@grouped
def batch(
    command: Commands,
    logs: Annotated[
        list[str],
        typer.Argument(
            metavar="GLOB|DIR|LOG...", help="Logs; for diagnose, folders of a car's logs."
        ),
    ],
    *,
    out: Out,
    workers: Workers = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="tcp://HOST:PORT", help="A Dask scheduler instead.")
    ] = None,
    options: JobOptions,
    fresh: Fresh = False,
    json: Json = False,
) -> None:
    """Run one command on many logs, one row per log.

    The rows are in DIR/results.parquet. A log that cannot be read is a row with its error; it
    changes the exit code only if no log can be read. A run that was stopped continues when it is
    started again. `fit` stores no tables. Exit code 0 if no log fails its limits, 1 if one does, 3
    if none could be read, 130 if stopped.
    """
    if workers is not None and scheduler is not None:
        raise typer.BadParameter("the scheduler has its own workers", param_hint="--workers")
    job = options.job(command, out)
    from calib.line.fleet.batch import run_batch

    with stoppable("stopped; the same command continues where it was"):
        executor = _executor(workers, scheduler)
        say(f"{command.value} on {executor.workers} worker{'s' * (executor.workers > 1)}")
        try:
            with _progress() as report, writing(out):
                done = run_batch(job, logs, out, executor, report, fresh)
        finally:
            executor.close()
    _tell(done, json)
    if done.unreadable:
        raise typer.Exit(UNREADABLE)
    if done.failed:
        raise typer.Exit(FAILED)


def _executor(workers: int | None, scheduler: str | None) -> "Executor":
    if scheduler is not None:
        from calib.line.fleet.workers import Cluster

        return Cluster(scheduler)
    from calib.base.processes import cores
    from calib.line.fleet.workers import Pool

    return Pool(workers or cores())


def _tell(done: "Batch", json: bool) -> None:
    counts = ", ".join(f"{n} {status}" for status, n in sorted(done.counts.items()))
    say(str(done.pace))
    if json:
        emit_json(done.document())
    else:
        emit(f"{counted(done.counts.total(), 'log')}: {counts}; {done.results}")


@contextmanager
def _progress() -> "Iterator[Callable[[Pace], None]]":
    """Show rate and remaining time in a bar, on a terminal only."""
    if is_watched():
        with progress_bar("", None, time_left=False) as bar:
            (task,) = bar.task_ids
            yield lambda pace: bar.update(
                task, description=str(pace), completed=pace.done, total=pace.total
            )
        return
    yield lambda _pace: None
