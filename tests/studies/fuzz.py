"""Feed every reader with mutated files, and list what is not refused as it should be.

python tests/studies/fuzz.py [--reader NAME ...] [--executions 100000] [--seconds 60] [--plain]
                             [--seed 1] [--keep DIR]

Guided by coverage where atheris is installed (`pip install 'brake-cal[fuzz]'`), else, or with
``--plain``, by chance alone. A finding is an exception that is no BrakeCalError, or a read that
computes for more than 10 s; equal ones are counted once, by the line of the program where they
happened. Each reader ends after ``--executions`` or ``--seconds``, whichever is first. ``--keep``
writes a file for each finding.
"""

import argparse
import json
import logging
import os
import random
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

SLOW = 10.0
"""Seconds of one read that count as a finding."""
HUNG = 300
"""Seconds of one read after which atheris ends the process. With 0, for none, it ends any process
after 300 s: its alarm goes off, and libFuzzer, which would judge it, does not listen."""


class Tally:
    """What one reader did: executions, and the findings by place."""

    def __init__(self, name: str, chosen: argparse.Namespace) -> None:
        from tests.support.fuzzed import READERS

        self.reader, self.chosen = READERS[name], chosen
        self.done, self.found = 0, dict[str, int]()
        self.start = time.monotonic()
        self.folder = tempfile.TemporaryDirectory()

    @property
    def over(self) -> bool:
        spent = time.monotonic() - self.start
        return self.done >= self.chosen.executions or spent > self.chosen.seconds

    def run(self, data: bytes) -> None:
        from tests.support.fuzzed import finding

        begun = time.process_time()
        error = finding(self.reader, Path(self.folder.name), data)
        self.done += 1
        if error is not None:
            self.note(place_of(error), data)
        elif time.process_time() - begun > SLOW:
            self.note(f"more than {SLOW:g} s", data)

    def note(self, place: str, data: bytes) -> None:
        self.found[place] = self.found.get(place, 0) + 1
        if self.chosen.keep and self.found[place] == 1:
            self.chosen.keep.mkdir(parents=True, exist_ok=True)
            (self.chosen.keep / f"{len(self.found)}-{self.reader.file}").write_bytes(data)

    def tell(self) -> None:
        told = {"executions": self.done, "seconds": time.monotonic() - self.start}
        print(json.dumps({**told, "found": self.found}), flush=True)


def place_of(error: Exception) -> str:
    """Kind of an error and the innermost line of the program."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if "/calib/" in f.filename]
    last = frames[-1] if frames else traceback.extract_tb(error.__traceback__)[-1]
    name = last.filename.partition("/calib/")[2] or last.filename
    return f"{type(error).__name__} in {name}:{last.lineno}"


def guided(tally: Tally) -> None:
    """Fuzz with atheris, which ends the process."""
    import atheris

    def one(data: bytes) -> None:
        tally.run(data)
        if tally.over:
            tally.tell()
            os._exit(0)

    with tempfile.TemporaryDirectory() as corpus:
        for number, seed in enumerate(tally.reader.seeds()):
            (Path(corpus) / str(number)).write_bytes(seed)
        atheris.Setup(
            [sys.argv[0], corpus, f"-seed={tally.chosen.seed}", "-max_len=200000",
             f"-timeout={HUNG}", "-rss_limit_mb=4000", "-verbosity=0"],
            one,
        )  # fmt: skip
        atheris.Fuzz()


def by_chance(tally: Tally) -> None:
    from tests.support.fuzzed import mutated

    chance, seeds = random.Random(tally.chosen.seed), tally.reader.seeds()
    while not tally.over:
        data = seeds[tally.done] if tally.done < len(seeds) else mutated(seeds, chance)
        tally.run(data)
    tally.tell()


def worker(name: str, chosen: argparse.Namespace) -> None:
    """Fuzz one reader in this process, and print what it did as a line of JSON."""
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    if chosen.plain:
        by_chance(Tally(name, chosen))
        return
    import atheris

    with atheris.instrument_imports(include=["calib", "tomllib"]):
        tally = Tally(name, chosen)
        for seed in tally.reader.seeds():  # imports what the reader needs
            tally.run(seed)
    guided(tally)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reader", action="append")
    parser.add_argument("--executions", type=int, default=100_000)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--plain", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.worker:
        worker(chosen.worker, chosen)
        return
    from tests.support.fuzzed import READERS

    plain = chosen.plain or find_spec("atheris") is None
    print("by chance" if plain else "guided by coverage")
    print(f"{'reader':12} {'executions':>10} {'seconds':>8} findings")
    for name in chosen.reader or READERS:
        words = [
            sys.executable,
            str(Path(__file__).resolve()),
            "--worker",
            name,
            "--seed",
            str(chosen.seed),
        ]
        words += ["--executions", str(chosen.executions), "--seconds", str(chosen.seconds)]
        words += ["--plain"] * plain + (
            ["--keep", str(chosen.keep.resolve() / name)] if chosen.keep else []
        )
        env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path[1:]])}
        with tempfile.TemporaryDirectory() as folder:  # libFuzzer writes into the one it runs in
            ran = subprocess.run(
                words, env=env, cwd=folder, capture_output=True, text=True, errors="replace"
            )
        lines = [line for line in ran.stdout.splitlines() if line.startswith('{"executions"')]
        if not lines:
            print(f"{name:12} ended with {ran.returncode}: {ran.stderr[-2000:]}", flush=True)
            continue
        told = json.loads(lines[-1])
        print(f"{name:12} {told['executions']:10} {told['seconds']:8.1f} {len(told['found'])}")
        for place, count in told["found"].items():
            print(f"    {count} times {place}", flush=True)


if __name__ == "__main__":
    main()
