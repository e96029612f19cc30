"""kill -9 by the clock, inside the store's write and while runs of a station are published.

    python tests/studies/kills.py --count 1000 --seed 5

A process stores tables, each released or rejected in the same step, and tells each when it is done;
another one publishes runs into one folder, a passed one with its export, then a failed one without.
Each is killed at a random moment, what it left is looked at, and the next one begins. The tests of
`tests/store` and `tests/base` kill before each change of the disk.
"""

import json
import os
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from itertools import count
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.publish import settle, workshop
from calib.base.write import write_whole
from calib.line.station.files import DOCUMENT, publish_run
from calib.store.state import StateDecision
from calib.store.store import Store
from tests.studies.study import arguments
from tests.support.tables import made_table


def killed(work: Callable[[int], object], longest: float, dice: random.Random) -> None:
    """Do the work again and again, in a process that is killed within ``longest`` [s]."""
    first = dice.randrange(2**30)
    child = os.fork()
    if child == 0:
        try:
            for number in count(first):
                work(number)
        finally:
            os._exit(1)
    time.sleep(dice.uniform(0.0, longest))
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if os.waitstatus_to_exitcode(status) != -signal.SIGKILL:
        raise RuntimeError("the process has failed by itself")


def patience(work: Callable[[], object]) -> float:
    """Four times what the work takes [s], once everything is imported."""
    work()
    begun = time.monotonic()
    work()
    return 4.0 * (time.monotonic() - begun)


def of_store(kills: int, dice: random.Random, home: Path) -> Counter[str]:
    """What is wrong in a store whose writers were killed; a new one every 25 kills."""
    counts, stiffness = Counter[str](), iter((26.0, 27.0))
    longest = patience(lambda: Store(home / "warm").save(made_table(next(stiffness))))
    for number in range(kills):
        store = Store(home / f"tables_{number // 25}")
        said = home / f"said_{number // 25}"

        def stored(seed: int, store: Store = store, said: Path = said) -> None:
            word = ("released", "rejected")[seed % 2]
            table = made_table(random.Random(seed).uniform(20.0, 40.0))
            made = store.save(table, StateDecision(word, "study", by="study"))
            with said.open("a") as file:
                file.write(f"{made.id} {word}\n")

        killed(stored, longest, dice)
        entries = {entry.id: entry for entry in store.list()} if store.folder.is_dir() else {}
        lines = said.read_text().splitlines(keepends=True) if said.exists() else []
        told = dict(line.split() for line in lines if line.endswith("\n"))
        counts["met a write"] += bool(store.folder.is_dir() and store.unfinished())
        counts["told and not there"] += len(told.keys() - entries.keys())
        counts["another state than told"] += sum(
            entries[key].state.word != word for key, word in told.items() if key in entries
        )
        counts["without a verdict"] += sum(e.state.word == "draft" for e in entries.values())
        counts["cannot be read"] += sum(bool(e.violations) for e in entries.values())
        if entries:
            counts["not sound"] += sum(not verdict.sound for verdict in store.verify())
    return counts


def published(number: int, out: Path) -> None:
    """Publish one run: even numbers pass."""
    passed = number % 2 == 0
    names = [f"stop_{number % 3}.parquet", "report.html", *(["table.dcm"] if passed else [])]
    with workshop(out) as work:
        for name in names:
            (work / name).write_text(str(number))
        document = {"run": number, "passed": passed, "files": names}
        write_whole(work / DOCUMENT, json.dumps(document).encode())
        publish_run(work, out)


def is_whole(out: Path) -> bool:
    """Whether the folder has all files of its verdict and no other, or no verdict."""
    if not (out / DOCUMENT).exists():
        return True
    verdict = json.loads((out / DOCUMENT).read_text())
    found = {
        path.name: path.read_text()
        for path in out.iterdir()
        if path.is_file() and path.name != DOCUMENT and not path.name.startswith(".")
    }
    return found == dict.fromkeys(verdict["files"], str(verdict["run"]))


def of_station(kills: int, dice: random.Random, home: Path) -> Counter[str]:
    """What is wrong in a folder whose publishers were killed."""
    counts, out = Counter[str](), home / "car"
    longest = patience(lambda: published(0, out))
    for _ in range(kills):
        killed(lambda number: published(number, out), longest, dice)
        counts["met an intent"] += (out / ".publishing").exists()
        counts["flaws after the kill"] += not is_whole(out)
        settle(out)
        counts["flaws after the next command"] += not is_whole(out)
        counts["no verdict after it"] += not (out / DOCUMENT).exists()
        counts["hidden files left"] += any(p.name.startswith(".") for p in out.iterdir())
    return counts


def main() -> None:
    """Run both and print their counts."""
    asked = arguments(__doc__, count=1000, seed=5)
    dice = random.Random(asked.seed)
    with tempfile.TemporaryDirectory() as folder:
        for study in (of_store, of_station):
            counts = study(asked.count, dice, Path(folder))
            print(f"{study.__name__}: " + ", ".join(f"{name} {n}" for name, n in counts.items()))


if __name__ == "__main__":
    main()
