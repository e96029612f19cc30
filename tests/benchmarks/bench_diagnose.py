"""Time and memory of `brake-cal diagnose` on cases of twelve logs of about ten seconds.

    python tests/benchmarks/bench_diagnose.py --seed 90

One case of each kind, eight logs to search and four to prove it on, as files; the whole process is
timed, report and replays included: with all cores, and with one process.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.support.hidden.cases import KINDS, draw, write


def main() -> None:
    """Draw, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=90)
    asked = parser.parse_args()
    print(
        "| kind | hidden | seconds | with one process | of these computing |\n|---|---|---|---|---|"
    )
    for kind in KINDS:
        case = draw(kind, asked.seed, severity=1)
        with tempfile.TemporaryDirectory() as folder:
            write(case, Path(folder))
            (wall, _), alone = timed(Path(folder)), timed(Path(folder), "--workers", "1")
            hidden = ", ".join(case.effects) or "nothing"
            print(f"| {kind} | {hidden} | {wall:.1f} | {alone[0]:.1f} | {alone[1]:.1f} |")
    largest = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
    print(f"\n{os.cpu_count()} cores; largest process {largest:.0f} MB")


def timed(folder: Path, *options: str) -> tuple[float, float]:
    """Wall time and processor time of one diagnosis [s]; they differ on a machine that is busy.

    The time of worker processes is not in the second one: they are no children of this one.
    """
    words = [sys.executable, "-m", "cli.main", "diagnose"]
    words += map(str, sorted((folder / "calibration").iterdir()))
    words += ["--holdout", *map(str, sorted((folder / "holdout").iterdir()))]
    words += ["--vehicle", str(folder / "vehicle.toml"), *options]
    words += ["--out", tempfile.mkdtemp(dir=folder)]
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, check=True, capture_output=True, cwd=Path(__file__).parents[2])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - start, cpu


if __name__ == "__main__":
    main()
