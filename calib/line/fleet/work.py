"""Process a log: read the log, run the command, return a row. An error becomes a row, too."""

import json
import pickle
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from calib.base.bounded import DBC, bytes_of
from calib.base.digest import sha256
from calib.base.errors import BatchError, BrakeCalError, ChannelMapError, printable
from calib.base.names import PROGRAM, VERSION
from calib.base.plain import finite_or_none
from calib.car.vehicle import Vehicle
from calib.estimation.limits import FAILED, Limit
from calib.line.fleet.rows import QUALITY, Cell, Command, Row, Status
from calib.logs.channel_map import ChannelMap
from calib.logs.log import Log
from calib.logs.read import REQUIRED, log_bytes, read_log
from calib.table.table import Table

Outcome = tuple[Status, tuple[Cell, ...]]  # result for one log: status and cells of the row


@dataclass(frozen=True)
class Job:
    """A command and all its inputs except the log."""

    command: Command
    table: Table | None = None  # needed by `validate`
    vehicle: Vehicle | None = None  # needed by `fit`
    limits: tuple[Limit, ...] = ()
    channel_map: ChannelMap | None = None
    version: str = VERSION  # of the program that makes the job

    def settings(self) -> dict[str, str]:
        """Return what the rows depend on besides the logs, each as a word or a digest."""
        return {
            "command": self.command,
            "table": self.table.digest if self.table else "none",
            "vehicle": _digest(asdict(self.vehicle)) if self.vehicle else "none",
            "limits": _digest([asdict(limit) for limit in self.limits]),
            "map": _map_digest(self.channel_map) if self.channel_map else "none",
            "program": self.version,
        }


def _map_digest(channel_map: ChannelMap) -> str:
    """Digest of a map and of its DBC files, by their content and not by their paths."""
    fields = asdict(channel_map)
    del fields["where"]
    fields["databases"] = {
        bus: [sha256(bytes_of(path, DBC, ChannelMapError, "a DBC")) for path in paths]
        for bus, paths in channel_map.databases.items()
    }
    return _digest(fields)


def _digest(value: object) -> str:
    return sha256(json.dumps(value, sort_keys=True, default=str).encode())


@dataclass(frozen=True)
class WorkItem:
    """A log to process."""

    name: str  # of its row
    path: str
    digest: str | None = None  # of an earlier row of the log


def run_items(packed: bytes, items: tuple[WorkItem, ...]) -> list[Row | None]:
    """Return the rows of some logs in their order; None for a log whose digest has not changed.

    ``packed`` is a pickled `Job`. Raises BatchError for a job of another version of the program.
    """
    job: Job = _unpacked(packed)
    if job.version != VERSION:
        expected = f"version {job.version}, which sent the logs"
        do = "install the same version on all workers"
        raise BatchError(f"a worker runs {PROGRAM}", expected=expected, do=do)
    return [_row_of(job, item) for item in items]


_unpacked = lru_cache(maxsize=2)(pickle.loads)  # a worker gets the same job with every chunk


def _row_of(job: Job, item: WorkItem) -> Row | None:
    digest, lost = None, False
    file = Path(item.path)
    try:
        data = log_bytes(file, item.name)
        digest = sha256(data)
        if digest == item.digest:
            return None
        require = () if job.command == Command.CHECK else REQUIRED
        log = read_log(Path(item.name), job.channel_map, require=require, data=data, file=file)
        status, cells = _RUNS[job.command](job, log)
        return Row(item.name, digest, status, None, cells)
    except BrakeCalError as error:
        text = str(error)
    except MemoryError:
        text, lost = f"{item.name}: not enough memory; the next run tries it again", True
    except Exception as error:
        # a bug in the program on one log must not stop the others
        text = f"{item.name}: the program failed: {type(error).__name__}: {error}"
    text = printable(text.replace(item.path, item.name))
    return Row(item.name, digest, Status.ERROR, text, lost=lost)


def _validate(job: Job, log: Log) -> Outcome:
    from calib.estimation.metrics import METRICS
    from calib.estimation.validate import validate_one

    assert job.table is not None
    result = validate_one(job.table, log, job.vehicle, job.limits)
    failed = (judgement.figure for judgement in result.judgements if judgement.verdict == FAILED)
    metrics = (finite_or_none(result.figures[name]) for name in METRICS)
    cells = (*metrics, _joined(failed), _joined(w.code for w in result.warnings))
    return (Status.PASSED if result.passed else Status.FAILED), cells


def _fit(job: Job, log: Log) -> Outcome:
    from calib.fitting.fit import fit

    assert job.vehicle is not None
    table = fit(job.vehicle, [log])
    calibration = table.calibration
    pads = (calibration.pad_friction_f, calibration.pad_friction_r, calibration.pad_scale)
    values, sigmas = [pad.value for pad in pads], [pad.sigma for pad in pads]
    metrics = [*values, *sigmas, *(table.quality[name] for name in QUALITY)]
    codes = _joined(w.code for w in table.warnings)
    return Status.DONE, (*map(finite_or_none, metrics), codes, table.digest)


def _check(job: Job, log: Log) -> Outcome:
    from calib.plausibility.check import check
    from calib.run.run import figures

    findings = check(log)
    usable = (verdict.usable for verdict in findings.verdicts)
    metrics = map(finite_or_none, figures(findings.run).values())
    cells = (*usable, *metrics, _joined(w.code for w in findings.warnings))
    return (Status.PASSED if findings.usable else Status.FAILED), cells


def _joined(words: Iterable[str]) -> str | None:
    """Return the different words in one text; None without a word."""
    return ", ".join(dict.fromkeys(words)) or None


_RUNS: dict[Command, Callable[[Job, Log], Outcome]] = {
    Command.FIT: _fit,
    Command.VALIDATE: _validate,
    Command.CHECK: _check,
}
