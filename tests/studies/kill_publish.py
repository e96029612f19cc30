"""kill -9 at random moments while runs of the station are published into one folder.

    python tests/studies/kill_publish.py --count 1000 --seed 1

A process publishes runs without a pause: a passed one with its export, then a failed one without,
each with another stop; and is killed at a random moment. Then the folder is looked at as it is, and
again after the next command, which is either another run or one that only settles. A flaw is a
verdict beside a file of another run, a verdict whose files are not all there, an export beside a
failed verdict, and after the next command also a missing verdict or a hidden file. It also counts
the same with two processes that publish into the folder at once; and how often a way of publishing
without an intent (the old verdict deleted, the files moved, the verdict last) leaves a flaw, to
show that the kills hit.
"""

import argparse
import json
import os
import random
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from itertools import count
from pathlib import Path

from calib.base.publish import settle, workshop
from calib.base.write import write_whole
from calib.line.station.files import DOCUMENT, publish_run

LONGEST = 0.02
"""Most time [s] between the first file of a process and its kill: a few runs."""


def run(out: Path, number: int, put: Callable[[Path, Path], object] = publish_run) -> None:
    """Publish one run: even numbers pass."""
    passed = number % 2 == 0
    names = [f"stop_{number % 3}.parquet", "report.html", *(["table.dcm"] if passed else [])]
    with workshop(out) as work:
        for name in names:
            (work / name).write_text(str(number))
        document = {"run": number, "passed": passed, "files": names}
        write_whole(work / DOCUMENT, json.dumps(document).encode())
        put(work, out)


def naive(work: Path, out: Path) -> None:
    """Without an intent: what the old verdict lists is not known once it is deleted."""
    listed = json.loads((out / DOCUMENT).read_text())["files"] if (out / DOCUMENT).exists() else []
    (out / DOCUMENT).unlink(missing_ok=True)
    for name in listed:
        (out / name).unlink(missing_ok=True)
    for path in sorted(work.iterdir(), key=lambda path: path.name == DOCUMENT):
        os.replace(path, out / path.name)


def flaws(out: Path) -> list[str]:
    """What is wrong in a folder that has a verdict; nothing is wrong without one."""
    if not (out / DOCUMENT).exists():
        return []
    verdict = json.loads((out / DOCUMENT).read_text())
    found = {
        path.name: path.read_text()
        for path in out.iterdir()
        if path.is_file() and path.name != DOCUMENT and not path.name.startswith(".")
    }
    wrong = [f"{n} of run {of}" for n, of in found.items() if of != str(verdict["run"])]
    wrong += [f"{name} is missing" for name in {*verdict["files"]} - {*found}]
    if not verdict["passed"] and "table.dcm" in found:
        wrong.append("an export beside a failed verdict")
    return wrong


def started(out: Path, first: int, put: Callable[[Path, Path], object]) -> int:
    """A child process that publishes from run ``first`` on."""
    child = os.fork()
    if child == 0:
        try:
            for number in count(first):
                run(out, number, put)
        finally:
            os._exit(1)  # an error: the parent sees it
    return child


def kill(child: int) -> None:
    """End a child process as the power switch does. Raises RuntimeError if it ended before."""
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if os.waitstatus_to_exitcode(status) != -signal.SIGKILL:
        raise RuntimeError("the process that publishes has failed")


def study(
    kills: int, seed: int, put: Callable[[Path, Path], object] = publish_run, writers: int = 1
) -> Counter[str]:
    """Counts of what the kills left and of flaws."""
    dice, counts = random.Random(seed), Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "car"
        run(out, 0, put)
        for number in range(1, 1 + kills):
            children = [started(out, 1000 * number + 200 * i, put) for i in range(writers)]
            time.sleep(dice.uniform(0.0, LONGEST))
            for child in children:
                kill(child)
            counts["killed with an intent"] += (out / ".publishing").exists()
            counts["killed with a work folder"] += any(p.is_dir() for p in out.glob(".making-*"))
            counts["killed without a verdict"] += not (out / DOCUMENT).exists()
            counts["flaws after the kill"] += bool(flaws(out))
            if dice.random() < 0.5:
                run(out, 1000 * number + 901 + dice.randrange(2), put)
            else:
                settle(out)
            counts["flaws after the next command"] += bool(flaws(out))
            counts["no verdict after the next command"] += not (out / DOCUMENT).exists()
            counts["hidden files left"] += any(p.name.startswith(".") for p in out.iterdir())
    return counts


def main() -> None:
    """Print the counts of this program, with one writer and two, and of the naive way."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    ours = study(given.count, given.seed)
    two = study(given.count, given.seed, writers=2)
    other = study(given.count, given.seed, naive)
    print(f"{given.count} kills, seed {given.seed}: one writer, two writers, without an intent")
    for name in ours:
        print(f"{name:<36}{ours[name]:>6}{two[name]:>6}{other[name]:>6}")


if __name__ == "__main__":
    main()
