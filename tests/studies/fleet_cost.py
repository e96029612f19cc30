"""How the cost of a batch grows with the number of logs: time, and peak memory of each process.

    python tests/studies/fleet_cost.py [MOST]

Runs `brake-cal batch validate` on 10, 100, 1,000 ... MOST (1,000 unless told otherwise) stops of
2,000 samples, as the shell would. The logs are hard links to 20 files. Reads /proc: Linux only.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from calib.car.vehicle_file import read_vehicle  # noqa: E402
from calib.store.store import Store  # noqa: E402
from tests.studies.fleet_logs import linked, table_of, write_logs  # noqa: E402


def peak(pid: int) -> float:
    """Most memory that a process has had [MB]; 0 if it is gone."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return sum(float(line.split()[1]) for line in lines if line.startswith("VmHWM")) / 1024


def measured(command: list[str]) -> tuple[float, float, float]:
    """Wall time [s], peak of the parent and of its largest worker [MB]."""
    start = time.perf_counter()
    silent = subprocess.DEVNULL
    process = subprocess.Popen(command, cwd=ROOT, stdout=silent, stderr=silent)
    parent = worker = 0.0
    while process.poll() is None:
        parent = max(parent, peak(process.pid))
        try:
            below = psutil.Process(process.pid).children(recursive=True)
        except psutil.Error:
            below = []
        worker = max([worker, *(peak(child.pid) for child in below)])
        time.sleep(0.2)
    assert process.returncode in (0, 1), process.returncode
    return time.perf_counter() - start, parent, worker


def main() -> None:
    """Print the table and its slope."""
    most = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    counts = [10**k for k in range(1, 7) if 10**k <= most]
    car = read_vehicle(ROOT / "sample_logs/sedan/vehicle.toml")
    rows = []
    with tempfile.TemporaryDirectory() as work:
        Store(Path(work, "tables")).save(table_of(car))
        paths = write_logs(car, Path(work, "distinct"), 20)
        print(f"{'logs':>7} {'time':>9} {'a log':>10} {'parent':>9} {'worker':>9} {'journal':>10}")
        for count in counts:
            folder, out = linked(paths, Path(work, f"logs_{count}"), count), f"{work}/out_{count}"
            command = [sys.executable, "-m", "cli.main", "batch", "validate", str(folder)]
            command += ["--table", car.name, "--store", f"{work}/tables", "--out", out]
            seconds, parent, worker = measured(command)
            journal = os.path.getsize(f"{out}/journal.sqlite") / count
            rows.append((count, seconds, parent, worker))
            print(
                f"{count:7d} {seconds:7.2f} s {1e3 * seconds / count:7.2f} ms {parent:6.0f} MB "
                f"{worker:6.0f} MB {journal:6.0f} B/log"
            )
    n, seconds, parent, worker = np.array(rows).T
    slope, first = np.polyfit(n, seconds, 1)
    print(f"time: {first:.2f} s + {1e3 * slope:.2f} ms a log")
    print(f"memory of the parent: {1e3 * np.polyfit(n, parent, 1)[0]:.2f} kB a log")
    print(f"memory of a worker:   {1e3 * np.polyfit(n, worker, 1)[0]:.2f} kB a log")


if __name__ == "__main__":
    main()
