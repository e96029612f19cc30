"""Kill -9 at random moments inside the store's write, and several writers at once.

    python tests/studies/kill_store.py --kills 1000 --writers 8 --seed 5

A writer process stores tables, each released or rejected in the same step, and says each when it is
done. It is killed at a random moment, by the clock or before a random change of the disk, the store
is read and verified, and the next one begins. Counted: kills, kills that met a write, versions that
were told and are not there, versions without a verdict, damaged ones, numbers given twice.
"""

import argparse
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from functools import partial
from pathlib import Path

from calib.store.state import StateDecision
from calib.store.store import Store
from tests.support.killed import killed
from tests.support.tables import made_table

ROOT = Path(__file__).parents[2]

WRITER = """
import random, sys
from calib.store.state import StateDecision
from calib.store.store import Store
from tests.support.tables import made_table
store, rng = Store(sys.argv[1]), random.Random(int(sys.argv[2]))
print("ready", flush=True)
for _ in range(int(sys.argv[3])):
    word = rng.choice(("released", "rejected"))
    decision = StateDecision(word, "study", by="study")
    stored = store.save(made_table(rng.uniform(20.0, 40.0)), decision)
    print(stored.id, stored.state.word, flush=True)
"""


def writer(folder: Path, seed: int, count: int) -> "subprocess.Popen[str]":
    """A process that stores ``count`` tables."""
    return subprocess.Popen(
        [sys.executable, "-c", WRITER, str(folder), str(seed), str(count)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )


def look(store: Store, told: dict[str, str], counts: Counter[str]) -> None:
    """Compare the store with what its writers said."""
    entries = {entry.id: entry for entry in store.list()} if store.folder.is_dir() else {}
    counts["told and not there"] += len(told.keys() - entries.keys())
    counts["another state than told"] += sum(
        entries[key].state.word != word for key, word in told.items() if key in entries
    )
    counts["without a verdict"] += sum(e.state.word == "draft" for e in entries.values())
    counts["cannot be read"] += sum(bool(e.violations) for e in entries.values())
    digests = [e.stored.digest for e in entries.values() if e.stored]
    counts["stored twice"] += len(digests) - len(set(digests))
    if entries:
        counts["not sound"] += sum(not verdict.sound for verdict in store.verify())
    counts["left over at most"] = max(counts["left over at most"], len(store.unfinished()))


def by_change(kills: int, rng: random.Random, folder: Path) -> Counter[str]:
    """Kill before a random change of the disk; a new store every 25 kills."""
    counts: Counter[str] = Counter()
    for number in range(kills):
        if number % 25 == 0:
            shutil.rmtree(folder, ignore_errors=True)
            store, told = Store(folder), dict[str, str]()
        table = made_table(rng.uniform(20.0, 40.0))
        word = rng.choice(("released", "rejected"))
        before = rng.randrange(22)
        counts["kills"] += 1
        save = partial(store.save, table, StateDecision(word, "study", by="study"))
        counts["met a write"] += killed(save, before)
        look(store, told, counts)
    return counts


def by_clock(kills: int, rng: random.Random, folder: Path) -> Counter[str]:
    """Kill a process that stores one table after the other, at a random time."""
    counts: Counter[str] = Counter()
    store, told = Store(folder), dict[str, str]()
    for number in range(kills):
        if number % 25 == 0:
            shutil.rmtree(folder, ignore_errors=True)
            told = {}
        process = writer(folder, rng.randrange(2**31), 10_000)
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(rng.uniform(0.0, 0.12))
        process.send_signal(signal.SIGKILL)
        said = process.communicate()[0].splitlines()
        told |= dict(line.split() for line in said if line.endswith(("released", "rejected")))
        counts["kills"] += 1
        counts["met a write"] += bool(store.unfinished())
        look(store, told, counts)
    return counts


def at_once(writers: int, each: int, rng: random.Random, folder: Path) -> Counter[str]:
    """Several writers on one store, none killed."""
    counts: Counter[str] = Counter()
    processes = [writer(folder, rng.randrange(2**31), each) for _ in range(writers)]
    told: dict[str, str] = {}
    for process in processes:
        told |= dict(line.split() for line in process.communicate()[0].splitlines()[1:])
        counts["writers that failed"] += process.returncode != 0
    counts["versions"] = len(Store(folder).list())
    counts["expected"] = writers * each
    look(Store(folder), told, counts)
    return counts


def main() -> None:
    """Run all three and print their counts."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--writers", type=int, default=8)
    parser.add_argument("--seed", type=int, default=5)
    given = parser.parse_args()
    rng = random.Random(given.seed)
    with tempfile.TemporaryDirectory() as folder:
        half = given.kills // 2
        for title, counts in (
            ("killed before a change of the disk", by_change(half, rng, Path(folder, "a"))),
            ("killed by the clock", by_clock(given.kills - half, rng, Path(folder, "b"))),
            (f"{given.writers} writers", at_once(given.writers, 25, rng, Path(folder, "c"))),
        ):
            print(f"{title}: " + ", ".join(f"{name} {n}" for name, n in counts.items()))


if __name__ == "__main__":
    main()
