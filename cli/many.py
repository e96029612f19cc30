"""`brake-cal batch`, `watch` and `fleet`: run one command on many logs, and compare the results."""

import json as json_module
import signal
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Annotated

from calib.base.errors import printable
from calib.line.fleet.rows import Command, Status
from cli import options
from cli.command import FAILED, UNREADABLE, Answer, command
from cli.console import STOP_SIGNALS, json_text, print_error, progress, say, this_run, usage_error
from cli.options import argument, option
from cli.outputs import check_folder, write_folder, writing

if TYPE_CHECKING:
    from calib.car.vehicle import Vehicle
    from calib.estimation.limits import Limit
    from calib.line.fleet.batch import BatchRun
    from calib.line.fleet.rows import Row
    from calib.line.fleet.work import Job

COMMANDS = tuple(command.value for command in Command)
_NAMES = "cli.many:COMMANDS"
_COMMAND = argument("fit, validate or check.", "COMMAND", typed=str, names=_NAMES, make=Command)
_CommandArgument = Annotated[Command, _COMMAND]


@dataclass(frozen=True)
class Inputs:
    """Options of `batch` and `watch`, which hold for all logs."""

    out: Annotated[Path, option("Write results.parquet and journal here.", "DIR", writes="folder")]
    workers: options.Workers
    table: Annotated[str | None, option("validate: name, name@version or path.", "TABLE")]
    store: options.Tables
    vehicle: Annotated[
        "Vehicle | None",
        options.vehicle(
            "fit, validate: vehicle file; only fit takes it from the settings.",
            setting="vehicle",
            when=lambda values: values["command"] == Command.FIT,
        ),
    ]
    limits: Annotated[
        "tuple[Limit, ...] | None",
        options.limits(
            "validate: limits for pass or fail.",
            options.LIMITS_OF_STOPS,
            always=False,
            when=lambda values: values["command"] == Command.VALIDATE,
        ),
    ]
    channel_map: options.Map

    def job(self, command: Command) -> "Job":
        """Return the work for each log. Refuses an option that is missing or not used."""
        from calib.car.vehicle import require_same_car
        from calib.estimation.limits import DEFAULTS
        from calib.line.fleet.results import NAME
        from calib.line.fleet.work import Job

        is_validation, is_fit = command is Command.VALIDATE, command is Command.FIT
        if is_validation and self.table is None:
            raise usage_error("missing; validate needs a table", "--table")
        if is_fit and self.vehicle is None:
            raise usage_error(f"missing; {options.NO_VEHICLE}", "--vehicle")
        for name, value, is_used in (
            ("--table", self.table, is_validation),
            ("--limits", self.limits, is_validation),
            ("--vehicle", self.vehicle, is_fit or is_validation),
        ):
            if value is not None and not is_used:
                raise usage_error(f"not used by {command.value}", name)
        check_folder(self.out, (NAME,))
        stored = self.store.load(self.table) if self.table else None
        if stored is not None:
            say(f"{stored.id} is {stored.state.description}")
            if self.vehicle is not None:
                require_same_car(stored.table.vehicle, self.vehicle, this_run().file("vehicle"))
        return Job(
            command=command,
            table=stored.table if stored else None,
            vehicle=self.vehicle,
            limits=(self.limits or DEFAULTS) if is_validation else (),
            channel_map=self.channel_map,
        )


@command(
    "brake-cal batch check sample_logs/sedan --out checked",
    "brake-cal batch validate 'sample_logs/sedan/*pads.csv' --table sedan-2up --out validated",
)
def batch(
    command: _CommandArgument,
    logs: list[str] = argument("Logs, or folders of logs.", "GLOB|DIR|LOG..."),
    *,
    inputs: Inputs,
    scheduler: str | None = option("Use a Dask scheduler.", "tcp://HOST:PORT"),
) -> Answer:
    """Run one command on many logs, one row per log.

    A log that cannot be read is a row with its error. A batch that was stopped continues when the
    same line is typed again. `fit` stores no tables. Exit code 0 if no log fails its limits, 1 if
    one does, 3 if none could be read, 130 if stopped.
    """
    from calib.base.plain import counted
    from calib.base.processes import cores
    from calib.line.fleet.batch import run_batch
    from calib.line.fleet.workers import Cluster, Pool

    if inputs.workers is not None and scheduler is not None:
        raise usage_error("not beside --scheduler, which has its own workers", "--workers")
    job, out = inputs.job(command), inputs.out
    executor = Cluster(scheduler) if scheduler else Pool(inputs.workers or cores())
    say(f"{command.value} on {counted(executor.workers, 'worker')}")
    with closing(executor), progress() as step, writing(out):

        def show_progress(run: "BatchRun") -> None:
            step(f"{run.finished} of {run.total} logs", run.finished, run.total)

        result = run_batch(job, logs, out, executor, show_progress)
    code = 0
    if result.counts[Status.ERROR] == result.finished:
        code = UNREADABLE
    elif result.counts[Status.FAILED] > 0:
        code = FAILED
    counts = ", ".join(f"{n} {status}" for status, n in sorted(result.counts.items()))
    text = f"{counted(result.finished, 'log')}: {counts}; {result.results}"
    return Answer(result.document(), text, code)


@command("brake-cal watch check sample_logs/sedan --out watched")
def watch(
    command: _CommandArgument,
    folder: Path = argument("Folder of logs.", "DIR"),
    *,
    inputs: Inputs,
    settle: float = option("Seconds until a log is complete.", "S", built_in=2.0, min=0.0),
    json: bool = option("Print one line of JSON per log.", None, "--json"),
) -> Answer:
    """Process each log that appears in a folder, until stopped.

    A line is printed per log, after its row is on the disk. A watch that was stopped continues
    where it was, and a log that changes is processed again. Ctrl-C or SIGTERM stop it after the
    logs that it has begun; a second signal stops it at once.
    """
    from calib.base.processes import cores
    from calib.line.fleet.results import NAME
    from calib.line.fleet.watch import watch as watch_folder
    from calib.line.fleet.workers import Pool

    if not folder.is_dir():
        raise usage_error(f"{folder} is no folder; expected a folder of logs", "DIR")
    job, out = inputs.job(command), inputs.out

    def on_row(row: "Row") -> None:
        document = {**row.head(), "figures": row.metrics(command)}
        line = json_module.dumps(document, allow_nan=False) if json else row.line(command)
        print(printable(line), flush=True)  # noqa: T201

    with closing(Pool(inputs.workers or cores())) as pool, writing(out), _stop_event() as stop:
        say(f"watching {folder} for logs to {command.value}; Ctrl-C ends it")
        result = watch_folder(job, folder, out, pool, stop, on_row, print_error, settle=settle)
    counts = ", ".join(f"{n} {status}" for status, n in sorted(result.items()))
    say(f"{counts}; {out / NAME}" if result else "no log came")
    return Answer({})


@contextmanager
def _stop_event() -> Iterator[Event]:
    """Yield an event. The first signal to stop sets this event, a second signal acts as usual."""
    stop = Event()
    usual_handlers = {number: signal.getsignal(number) for number in STOP_SIGNALS}

    def stop_and_restore(*_signal: object) -> None:
        stop.set()
        for number, handler in usual_handlers.items():
            signal.signal(number, handler or signal.SIG_DFL)

    for number in usual_handlers:
        signal.signal(number, stop_and_restore)
    try:
        yield stop
    finally:
        stop_and_restore()  # only to restore: nobody reads the event after this


@command(
    "brake-cal fleet checked/results.parquet --out fleet",
    "brake-cal fleet validated/results.parquet --json",
    "brake-cal fleet runs",
)
def fleet(
    results: Path = argument("File of `batch`, or runs of `station`.", "RESULTS.parquet|DIR"),
    *,
    out: Path | None = option("Write report.html and fleet.json here.", "DIR", writes="folder"),
) -> Answer:
    """Show what stands apart in a batch, or the last cars of a station.

    RESULTS.parquet of a batch gives distributions and outliers. A DIR, whose folders are runs of
    `station --out`, gets DIR/index.html with verdicts, next steps and trends, and DIR/live.html,
    which reloads itself.
    """
    from calib.base.plain import counted
    from calib.line.fleet.results import open_fleet
    from calib.line.fleet.summary import document, summarise
    from calib.line.station.index import INDEX, LIVE
    from calib.show.facts import facts_of
    from calib.show.html import page_of
    from calib.show.station_index import write_index

    if results.is_dir():
        if out:
            raise usage_error("not with a DIR: the pages are written into this folder", "--out")
        with writing(results, "DIR"):
            number = write_index(results)
        if number == 0:
            say(f"no folder in {results} is a run of `brake-cal station --out`")
        files = [results / INDEX, results / LIVE]
        return Answer({"runs": number, "files": files}, f"{counted(number, 'run')}; {files[0]}")
    check_folder(out, ("fleet.json", "report.html"))
    summary = summarise(open_fleet(results))
    if out is not None:
        title = printable(f"{results.absolute().parent.name}/{results.name}")
        with progress("drawing the report"):
            page = page_of(replace(facts_of(summary), title=title)).encode()
        contents = (("report.html", page), ("fleet.json", json_text(document(summary)).encode()))
        write_folder(out, contents, "fleet.json")
    return Answer(document(summary), summary)
