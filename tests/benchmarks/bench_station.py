"""Where the time of one car at the station goes: imports, reading, fit, stops, drawing, files.

    python tests/benchmarks/bench_station.py [RUNS]

Runs the sample car (a ramp, a coast and three stops) in a fresh interpreter each time, as the line
does, and prints the wall time of the command, and its parts under a profile.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SEDAN = Path(__file__).parents[2] / "sample_logs" / "sedan"
STOPS = ("dry_asphalt_stop", "transition_dry_to_basalt", "ramp_wet_asphalt_repeat")
GOAL = 4.0
"""Wall time of a verdict [s]."""

PARTS = """
import json, sys, time
from cli.main import main
start = time.perf_counter()
import numpy, scipy.optimize, scipy.signal, pyarrow.parquet, pyarrow.csv, matplotlib.figure
import cProfile, pstats
imported = time.perf_counter() - start
profile = cProfile.Profile()
try:
    profile.runcall(main)
except SystemExit:
    pass
names = ("read_log", "table_of", "validated", "outcome", "save", "page_of", "write_all")
found = {name: 0.0 for name in names}
for (_, _, name), (*_, seconds, _) in pstats.Stats(profile).stats.items():
    if name in found:
        found[name] = max(found[name], seconds)
print(json.dumps({"imports of libraries": imported, **found}), file=sys.stderr)
"""
"""Runs the command line under a profile; one part holds another, as write_all the report."""


def run(how: list[str], out: Path) -> tuple[float, str]:
    """Wall time [s] and the last line on stderr of the command as typed at the line."""
    logs = [str(SEDAN / f"{n}.csv") for n in ("ramp_wet_asphalt", *STOPS)]
    options = {
        "--coast": SEDAN / "coast.csv",
        "--vehicle": SEDAN / "vehicle.toml",
        "--out": out / "line",
        "--store": out / "tables",
        "--export": "dcm",
    }
    words = [*logs, *(str(word) for pair in options.items() for word in pair)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, *how, "station", *words], capture_output=True, text=True, env=environment
    )
    return time.perf_counter() - start, done.stderr.splitlines()[-1]


def main() -> None:
    """Print the wall time and the parts."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    with tempfile.TemporaryDirectory() as name:
        walls = [run(["-m", "cli.main"], Path(name))[0] for _ in range(runs)]
        parts = json.loads(run(["-c", PARTS], Path(name))[1])
    for label, seconds in parts.items():
        print(f"{label:<24} {seconds:6.2f} s")
    print(f"the command, fastest {min(walls):.2f} s, median {sorted(walls)[runs // 2]:.2f} s "
          f"(goal {GOAL:g} s)")  # fmt: skip


if __name__ == "__main__":
    main()
