"""Many small logs from few: the same run under names and header cells of its own."""

from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future
from pathlib import Path

from calib.estimation.limits import DEFAULTS
from calib.line.fleet.work import Job, WorkItem, run_items
from calib.line.fleet.workers import Rows
from calib.logs.log import Log
from calib.logs.write import write_csv
from calib.table.table import Table


def many(folder: Path, logs: list[Log], count: int) -> Path:
    """``count`` logs in ``folder``; each differs from every other in the name of a spare column."""
    folder.mkdir(parents=True)
    texts = []
    for log in logs:
        write_csv(log, folder / "one.csv")
        lines = (folder / "one.csv").read_text().splitlines()
        texts.append((lines[0], "\n".join(f"{line},0" for line in lines[1:]) + "\n"))
    (folder / "one.csv").unlink()
    for i in range(count):
        head, body = texts[i % len(texts)]
        (folder / f"car_{i:05d}.csv").write_text(f"{head},spare_{i:05d}\n{body}")
    return folder


def validating(table: Table) -> Job:
    """A validation by the usual limits."""
    return Job("validate", table=table, limits=DEFAULTS)


class Here:
    """An executor without processes; ``kills`` says on which logs a worker dies."""

    workers = 2

    def __init__(self, kills: Callable[[str], bool] = lambda name: False):
        self.kills, self.done, self.renewed = kills, list[str](), 0

    def submit(self, packed: bytes, items: tuple[WorkItem, ...]) -> Future[Rows]:
        future: Future[Rows] = Future()
        if any(self.kills(item.name) for item in items):
            future.set_exception(BrokenExecutor("killed"))
        else:
            self.done += [item.name for item in items]
            future.set_result(run_items(packed, items))
        return future

    def renew(self) -> None:
        self.renewed += 1

    def close(self) -> None:
        pass
