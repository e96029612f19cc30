"""Speed of a batch against the plain way, and on one core against two, in one run.

    python tests/benchmarks/bench_batch.py [LOGS]

Validates LOGS (400 unless told otherwise) stops of 2,000 samples, CSV in, figures out. Prints rates
and ratios; nothing is asserted, machines differ.
"""

import os
import pickle
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from calib.base.names import G  # noqa: E402
from calib.car.model import default_model  # noqa: E402
from calib.car.vehicle import Vehicle  # noqa: E402
from calib.car.vehicle_file import read_vehicle  # noqa: E402
from calib.estimation import baselines, estimator  # noqa: E402
from calib.estimation.limits import DEFAULTS  # noqa: E402
from calib.fitting.fit import fit  # noqa: E402
from calib.line.fleet.batch import run_batch  # noqa: E402
from calib.line.fleet.work import Job, WorkItem, run_items  # noqa: E402
from calib.line.fleet.workers import Pool  # noqa: E402
from calib.logs.read import read_log  # noqa: E402
from calib.logs.write import write_csv  # noqa: E402
from calib.model.manoeuvre import manoeuvre  # noqa: E402
from calib.model.sensor_noise import add_noise  # noqa: E402
from calib.model.simulate import simulate  # noqa: E402
from calib.table.table import Table  # noqa: E402

COLUMNS = ["p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr"]


def best(
    call: Callable[[], object], repeat: int, clock: Callable[[], float] = time.perf_counter
) -> float:
    """Least time of several calls [s]: the one the machine disturbed least."""
    times = []
    for _ in range(repeat):
        start = clock()
        call()
        times.append(clock() - start)
    return min(times)


def table_of(car: Vehicle) -> Table:
    """A table of the car, fitted on a simulated ramp."""
    drive = manoeuvre("ramp", 33.0)
    log = simulate(default_model(car), drive.time, drive.pressure, drive.v0, name="ramp")
    return fit(car, [add_noise(replace(log, truth={}), 0)])


def write_logs(car: Vehicle, folder: Path, distinct: int, count: int) -> list[Path]:
    """``count`` names, hard links, for ``distinct`` stops without truth, as CSV."""
    folder.mkdir()
    time, paths = np.arange(2000) / 200.0, []
    for i in range(count):
        paths.append(folder / f"car_{i:06d}.csv")
        if i >= distinct:
            os.link(paths[i % distinct], paths[-1])
            continue
        pressure = np.clip((time - 1.5) / 0.25, 0.0, 1.0) * (12.0 + 0.5 * (i % 7)) * 1e5
        log = simulate(default_model(car), time, pressure, 33.0, name=f"stop_{i}")
        write_csv(add_noise(replace(log, truth={}), i + 1), paths[-1])
    return paths


def plain_law(table: Table, path: Path) -> list[float]:
    """The paper's law, (1)-(28), over rows of pandas: zero, loads, look-up, (23)-(28) in front."""
    frame = pd.read_csv(path)
    frame.columns = [name.split(" ")[0] for name in frame.columns]
    car, curve, axle = table.vehicle, table.difference, table.vehicle.front
    gamma, dt = baselines.gain(axle), 0.005
    eta_zero, seen, zeta, out = 0.0, 0, 0.0, []
    for _, row in frame.iterrows():
        p, a_x, fl, fr, rl, rr = (row[c] for c in COLUMNS)
        z, eta = -a_x / G, (rl + rr) / (fl + fr)
        if p < 1.0 and not out:
            eta_zero, seen = eta_zero + eta, seen + 1
            continue
        D = float(np.interp(eta * seen / eta_zero, curve.eta, curve.D))
        load_f = car.weight * (car.cg_to_rear_axle + z * car.cg_height) / car.wheelbase
        force = z + D * (car.weight - load_f) / car.weight
        u = -axle.torque_gain * 1e5 * p
        y = -force * axle.rolling_radius * 0.5 * load_f - axle.pad_friction * u
        if p > 2.0:
            zeta += gamma * dt * u * (y - zeta * u)
        out.append(axle.pad_friction + zeta)
    return out


def one_core(job: Job, table: Table, paths: list[Path]) -> None:
    """One log after the other in this process, and the plain way on the same logs."""
    packed = pickle.dumps(job)
    items = tuple(WorkItem(path.name, str(path)) for path in paths)
    print("status of the rows:", *sorted({row.status for row in run_items(packed, items) if row}))
    ours = best(lambda: run_items(packed, items), 5) / len(items)
    print(f"{'batch validate, one core':<40}{1e3 * ours:8.2f} ms a log {1 / ours:8.1f} logs/s")
    plain = best(lambda: [plain_law(table, p) for p in paths[:3]], 3) / 3
    print(f"{'pandas, iterrows, the law of one axle':<40}{1e3 * plain:8.2f} ms a log")
    log = read_log(paths[0])
    print(f"  of it reading    {1e3 * best(lambda: read_log(paths[0]), 20):8.2f} ms")
    alone = best(lambda: estimator.estimate(table, log), 20)
    print(f"  of it estimating {1e3 * alone:8.2f} ms")


def whole_batches(job: Job, folder: Path, work: Path, count: int) -> None:
    """Batches with journal and results on one and two worker processes, turn by turn."""
    pools = {n: Pool(n) for n in (1, 2)}
    times: dict[int, list[float]] = {1: [], 2: []}
    for n, pool in pools.items():  # the workers' imports are no part of it
        run_batch(job, [str(folder / "car_00000[0-9].csv")], work / f"warm_{n}", pool)
    for turn in range(3):
        for n, pool in pools.items():
            start = time.perf_counter()
            run_batch(job, [str(folder)], work / f"out_{n}_{turn}", pool)
            times[n].append(time.perf_counter() - start)
    for n, pool in pools.items():
        print(f"batch of {count} with journal, {n} workers {count / min(times[n]):8.1f} logs/s")
        pool.close()
    print(f"scaling on two cores {min(times[1]) / min(times[2]):.2f} (load of the machine "
          f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} cores)")  # fmt: skip
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory of this process {peak:.0f} MB")


def main() -> None:
    """Print all figures."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    car = read_vehicle(ROOT / "sample_logs/sedan/vehicle.toml")
    table = table_of(car)
    job = Job("validate", table=table, limits=DEFAULTS)
    with tempfile.TemporaryDirectory() as work:
        paths = write_logs(car, Path(work, "logs"), 20, count)
        one_core(job, table, paths[:20])
        whole_batches(job, Path(work, "logs"), Path(work), count)


if __name__ == "__main__":
    main()
