"""Where the time of one car at the station goes: imports, reading, fit, stops, drawing, files.

    python tests/benchmarks/bench_station.py [--runs N]

Runs the sample car (a ramp, a coast and three stops) in a fresh interpreter each time, as the line
does, and prints the parts of the fastest run and the wall time of the command itself.
"""

import argparse
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
from pathlib import Path
marks = [("", time.perf_counter())]
def mark(name): marks.append((name, time.perf_counter()))
sedan, out, stops = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]
import numpy, pyarrow.parquet, pyarrow.csv, scipy.optimize, scipy.signal, scipy.special
mark("imports: numpy, scipy, pyarrow")
import matplotlib.figure, matplotlib.backends.backend_svg
mark("imports: matplotlib")
import cli.main
from calib.logs.read import read_log
from calib.line.station.limits_file import LIMITS
from calib.line.station.metrics import Car
from calib.base.publish import workshop
from calib.line.station.folder import publish_run
from calib.line.station.identity import Identity
from calib.show.station_page import report_html
from calib.line.station.station import outcome, table_of, validated
from calib.show.station_files import write_all
from calib.store.store import Store
from calib.car.vehicle_file import read_vehicle
mark("imports: brake-cal")
car = read_vehicle(sedan / "vehicle.toml")
logs = [read_log(sedan / f"{n}.csv") for n in ("ramp_wet_asphalt", "coast")]
held = [read_log(sedan / f"{n}.csv") for n in stops]
mark("reading five logs")
table = table_of(car, logs[:1], logs[1:], Identity(serial="1"))
mark("fit")
results = [validated(table, log, LIMITS) for log in held]
mark("three stops")
found = outcome(Car(table, logs[:1], held, results), logs[1:], LIMITS, Identity(serial="1"))
mark("check and verdict")
with workshop(out / "car") as work:
    stored = Store(out / "tables").save(table)
    mark("store")
    report_html(found, stored)
    mark("report, drawn")
    write_all(found, stored, ["dcm"], "", work)
    mark("files, with the report once more")
    publish_run(work, out / "car")
print(json.dumps({name: t - before for (_, before), (name, t) in zip(marks, marks[1:])}))
"""


def run(command: list[str]) -> tuple[float, str]:
    """Wall time [s] and standard output of a command."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    start = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    return time.perf_counter() - start, done.stdout


def command(out: Path) -> list[str]:
    """The command as typed at the line."""
    logs = [str(SEDAN / f"{n}.csv") for n in ("ramp_wet_asphalt", *STOPS)]
    options = {
        "--coast": SEDAN / "coast.csv",
        "--vehicle": SEDAN / "vehicle.toml",
        "--out": out / "line",
        "--store": out / "tables",
        "--export": "dcm",
    }
    told = [str(word) for pair in options.items() for word in pair]
    return [sys.executable, "-m", "cli.main", "station", *logs, *told]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as name:
        out = Path(name)
        walls = [run(command(out))[0] for _ in range(runs)]
        inside = [sys.executable, "-c", PARTS, str(SEDAN), name, *STOPS]
        parts = min(
            (json.loads(run(inside)[1]) for _ in range(runs)), key=lambda p: sum(p.values())
        )
    drawn = parts["report, drawn"]
    parts["files, with the report once more"] -= drawn
    parts["files"] = parts.pop("files, with the report once more")
    for label, seconds in parts.items():
        print(f"{label:<32} {seconds:6.2f} s")
    print(f"{'sum of the parts':<32} {sum(parts.values()):6.2f} s")
    print(f"{'the command, wall, fastest':<32} {min(walls):6.2f} s  (goal {GOAL:g} s)")
    print(f"{'the command, wall, median':<32} {sorted(walls)[len(walls) // 2]:6.2f} s")


if __name__ == "__main__":
    main()
