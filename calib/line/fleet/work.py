"""Work on one log: read it, run the command, return its row. Errors become rows."""

import hashlib
import json
import pickle
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

from calib.base.errors import BatchError, BrakeCalError, printable
from calib.base.names import PROGRAM, VERSION
from calib.base.plain import finite
from calib.base.warning import PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.estimation.limits import FAILED, Limit
from calib.line.fleet.rows import QUALITY, Cell, Command, Row, Status
from calib.logs.channel_map import ChannelMap
from calib.logs.formats import ending_of
from calib.logs.log import Log
from calib.logs.read import FORMATS, REQUIRED, log_bytes, read_log
from calib.table.table import Table

VEHICLE = "vehicle.toml"
CALIBRATION, HOLDOUT = "calibration", "holdout"

Files = dict[str, bytes]
Outcome = tuple[Status, tuple[Cell, ...]]


@dataclass(frozen=True)
class Job:
    """A command and its inputs: `validate` needs a table and limits, `fit` a vehicle."""

    command: Command
    table: Table | None = None
    vehicle: Vehicle | None = None
    limits: tuple[Limit, ...] = ()
    channel_map: ChannelMap | None = None
    version: str = VERSION

    def settings(self) -> dict[str, str]:
        """What the rows depend on besides the logs, each as a word or a digest."""
        return {
            "command": self.command,
            "table": self.table.digest if self.table else "none",
            "vehicle": _digest(asdict(self.vehicle)) if self.vehicle else "none",
            "limits": _digest([asdict(limit) for limit in self.limits]),
            "map": _map_digest(self.channel_map) if self.channel_map else "none",
            "program": self.version,
        }


def _map_digest(mapped: ChannelMap) -> str:
    """Digest of a map and of the content of the files that describe frames, not of their paths."""
    content = asdict(mapped)
    del content["where"]
    content["databases"] = {
        bus: [_sha256(log_bytes(path, any_format=True)) for path in paths]
        for bus, paths in mapped.databases.items()
    }
    return _digest(content)


def _digest(value: object) -> str:
    return _sha256(json.dumps(value, sort_keys=True, default=str).encode())


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


@dataclass(frozen=True)
class WorkItem:
    """A log to process: its name in the results, its path, and the digest in its row, if any."""

    name: str
    path: str
    digest: str | None = None


def run_items(packed: bytes, items: tuple[WorkItem, ...]) -> list[Row | None]:
    """Rows of some logs in their order; None for a log whose digest has not changed.

    ``packed`` a pickled `Job`. Raises BatchError if it comes from another version of the program.
    """
    job: Job = _unpacked(packed)
    if job.version != VERSION:
        raise BatchError(
            f"a worker runs {PROGRAM}",
            expected=f"version {job.version}, which sent the logs",
            do="install the same version on all workers",
        )
    return [_run_item(job, item) for item in items]


_unpacked = lru_cache(maxsize=2)(pickle.loads)


def _run_item(job: Job, item: WorkItem) -> Row | None:
    digest, lost = None, False
    try:
        files = _contents(job, item)
        digest = _digest_of(files)
        if digest == item.digest:
            return None
        status, cells = _RUNS[job.command](job, item, files)
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


def _digest_of(files: Files) -> str:
    """SHA-256 of a log's bytes; of names and digests of its files if it is a folder."""
    if len(files) == 1:
        return _sha256(*files.values())
    lines = (f"{_sha256(data)}  {name}\n" for name, data in files.items())
    return _sha256("".join(lines).encode())


def _contents(job: Job, item: WorkItem) -> Files:
    """Bytes of the log, which has the name "", or of all files of its folder."""
    root, names = Path(item.path), [""]
    if job.command == Command.DIAGNOSE:
        logs = sorted(p for part in (CALIBRATION, HOLDOUT) for p in (root / part).glob("*"))
        logs = [p for p in logs if ending_of(p) in FORMATS and not p.name.startswith(".")]
        names = [VEHICLE, *(p.relative_to(root).as_posix() for p in logs)]
    where = {name: f"{item.name}/{name}".removesuffix("/") for name in names}
    return {n: log_bytes(root / n, where[n], any_format=n == VEHICLE) for n in names}


def _logs(job: Job, item: WorkItem, files: Files, part: str = "") -> list[Log]:
    """The logs of a part of the folder; the log itself without one."""
    require = () if job.command == Command.CHECK else REQUIRED
    return [
        read_log(Path(item.name, name), job.channel_map, require=require, data=data,
                 file=Path(item.path, name))
        for name, data in files.items()
        if name.startswith(part)
    ]  # fmt: skip


def _validate(job: Job, item: WorkItem, files: Files) -> Outcome:
    from calib.estimation.metrics import METRICS
    from calib.estimation.validate import validate_one

    assert job.table is not None
    (log,) = _logs(job, item, files)
    result = validate_one(job.table, log, job.vehicle, job.limits)
    not_held = ", ".join(j.figure for j in result.judgements if j.verdict == FAILED)
    metrics = (finite(result.figures[name]) for name in METRICS)
    cells = (*metrics, not_held or None, _codes(result.warnings))
    return Status.PASSED if result.passed else Status.FAILED, cells


def _fit(job: Job, item: WorkItem, files: Files) -> Outcome:
    from calib.fitting.fit import fit

    assert job.vehicle is not None
    table = fit(job.vehicle, _logs(job, item, files))
    cal, q = table.calibration, table.quality
    pads = (cal.pad_friction_f, cal.pad_friction_r, cal.pad_scale)
    metrics = [*(p.value for p in pads), *(p.sigma for p in pads), *(q[name] for name in QUALITY)]
    return Status.DONE, (*map(finite, metrics), _codes(table.warnings), table.digest)


def _codes(warnings: Iterable[PlausibilityWarning]) -> str | None:
    return ", ".join(dict.fromkeys(one.code for one in warnings)) or None


def _check(job: Job, item: WorkItem, files: Files) -> Outcome:
    from calib.plausibility.check import check
    from calib.run.run import figures

    (log,) = _logs(job, item, files)
    findings = check(log)
    usable = (verdict.usable for verdict in findings.verdicts)
    metrics = map(finite, figures(findings.run).values())
    cells = (*usable, *metrics, _codes(findings.warnings))
    return Status.PASSED if findings.usable else Status.FAILED, cells


def _diagnose(job: Job, item: WorkItem, files: Files) -> Outcome:
    from calib.car.vehicle_file import read_vehicle
    from calib.diagnosis.diagnose import diagnose

    vehicle = read_vehicle(Path(item.path) / VEHICLE)
    runs, held_out = (_logs(job, item, files, f"{part}/") for part in (CALIBRATION, HOLDOUT))
    diagnosis = diagnose(vehicle, runs, held_out)
    gap = (diagnosis.gap.rms_before, diagnosis.gap.rms_after, diagnosis.gap.closed)
    names = "+".join(effect.name for effect in diagnosis.effects)
    return Status.DONE, (diagnosis.verdict, names, *map(finite, gap))


_RUNS: dict[Command, Callable[[Job, WorkItem, Files], Outcome]] = {
    Command.FIT: _fit,
    Command.VALIDATE: _validate,
    Command.CHECK: _check,
    Command.DIAGNOSE: _diagnose,
}
