"""Speed of a batch against the plain ways, and on one core against two, in one run.

    python tests/benchmarks/bench_batch.py [LOGS]

Validates LOGS (400 unless told otherwise) stops of 2,000 samples, CSV in, figures out. Prints rates
and ratios; nothing is asserted, machines differ.
"""

import os
import resource
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from calib.base.names import G  # noqa: E402
from calib.car.vehicle_file import read_vehicle  # noqa: E402
from calib.estimation import adaptive, estimator  # noqa: E402
from calib.estimation.limits import DEFAULTS  # noqa: E402
from calib.estimation.plan import plan_for  # noqa: E402
from calib.estimation.weighed_level import weigh_level  # noqa: E402
from calib.line.fleet.batch import run_batch  # noqa: E402
from calib.line.fleet.work import (  # noqa: E402
    Job,
    WorkItem,
    run_items,
)
from calib.line.fleet.workers import Pool  # noqa: E402
from calib.logs.read import read_log  # noqa: E402
from calib.run.axle_signals import signals  # noqa: E402
from calib.run.blocks import blocks  # noqa: E402
from calib.run.brake_balance import brake_balance  # noqa: E402
from calib.table.table import Table  # noqa: E402
from tests.benchmarks.timing import best  # noqa: E402
from tests.studies.fleet_logs import linked, table_of, write_logs  # noqa: E402

REPEAT = 3


@dataclass
class Law:
    """(1)-(28) of one axle, a sample at a time, in plain Python."""

    gain: float
    radius: float
    nominal: float
    gamma: float
    zeta: float = 0.0

    def step(self, force: float, load: float, spin: float, pressure: float, dt: float) -> float:
        """Pad friction after one more sample."""
        u = -self.gain * pressure
        y = spin - force * self.radius * load + self.nominal * self.gain * pressure
        if pressure > 2e5:
            self.zeta += self.gamma * dt * u * (y - self.zeta * u)
        return self.nominal + self.zeta


def plain_law(table: Table, rows: Iterable[tuple[float, ...]], dt: float) -> list[float]:
    """The paper's law over rows of (p, a_x, four wheels): zero, loads, look-up, (23)-(28)."""
    car = table.vehicle
    laws = [
        Law(a.torque_gain, a.rolling_radius, a.pad_friction, adaptive.gain(a))
        for a in (car.front, car.rear)
    ]
    eta_zero, seen, out = 0.0, 0, []
    curve = table.difference
    for p, a_x, fl, fr, rl, rr in rows:
        z = -a_x / G
        eta = (rl + rr) / (fl + fr)
        if p < 1e5 and not out:
            eta_zero, seen = eta_zero + eta, seen + 1
            continue
        D = float(np.interp(eta * seen / eta_zero, curve.eta, curve.D))
        load_f = car.weight * (car.cg_to_rear_axle + z * car.cg_height) / car.wheelbase
        load_r = car.weight - load_f
        F_f, F_r = z + D * load_r / car.weight, z - D * load_f / car.weight
        mu_f = laws[0].step(F_f, 0.5 * load_f, 0.0, p, dt)
        laws[1].step(F_r, 0.5 * load_r, 0.0, p, dt)
        out.append(mu_f)
    return out


COLUMNS = ["p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr"]


def read_plainly(path: Path) -> pd.DataFrame:
    """The log by pandas, in SI."""
    frame = pd.read_csv(path)
    frame.columns = [name.split(" ")[0] for name in frame.columns]
    frame["p_mc"] *= 1e5
    return frame


def handed_over(frame: pd.DataFrame) -> Iterator[tuple[float, ...]]:
    """Rows as pandas hands them over: iterrows."""
    return (tuple(row[c] for c in COLUMNS) for _, row in frame.iterrows())


def rows_by_pandas(table: Table, path: Path) -> None:
    """The paper's law over rows of pandas."""
    plain_law(table, handed_over(read_plainly(path)), 0.005)


def rows_by_lists(table: Table, path: Path) -> None:
    """Rows as plain tuples, which is the fastest loop that pandas allows."""
    frame = read_plainly(path)
    plain_law(table, frame[COLUMNS].itertuples(index=False, name=None), 0.005)


def filter_each_sample(table: Table, path: Path) -> None:
    """The product's own law, the split filter, with a step for every row instead of 50 ms."""
    rows = np.array(list(handed_over(read_plainly(path))))
    assert np.isfinite(rows).all()
    log = read_log(path)  # the same rows, as the filter wants them
    s = signals(log, table.vehicle)
    each = blocks(s, s.sample_time)
    plan = plan_for(table, log, s)
    forces = brake_balance(plan.nominal, plan.known.effects, s)
    level = estimator.level_of(plan, s, forces)
    weighed = weigh_level(plan, s.speed, s.z, np.zeros(s.z.size), level)
    demand = estimator.demand_of(plan, s, each, level, weighed)
    estimator.split_of(plan, each, demand)


def main() -> None:
    """Print all figures."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    car = read_vehicle(ROOT / "sample_logs/sedan/vehicle.toml")
    table = table_of(car)
    job = Job("validate", table=table, limits=DEFAULTS)
    with tempfile.TemporaryDirectory() as work:
        paths = write_logs(car, Path(work, "distinct"), 20)
        folder = linked(paths, Path(work, "logs"), count)
        one_core(job, paths)
        whole_batches(job, folder, Path(work), count)


def one_core(job: Job, paths: list[Path]) -> None:
    """One log after the other in this process, and the plain ways on the same logs."""
    assert job.table is not None
    packed = job.packed()
    items = tuple(WorkItem(path.name, str(path)) for path in paths)
    rows = run_items(packed, items)
    print("status of the rows:", *sorted({row.status for row in rows if row}))
    ours = best(lambda: run_items(packed, items), 5) / len(items)
    print(f"{'batch validate, one core':<52}{1e3 * ours:8.2f} ms a log {1 / ours:8.1f} logs/s")
    cpu = best(lambda: run_items(packed, items), 5, time.process_time) / len(items)
    said = "  by the clock of this process alone"
    print(f"{said:<52}{1e3 * cpu:8.2f} ms a log {1 / cpu:8.1f} logs/s")
    for name, way in (
        ("pandas, iterrows, the paper's law", rows_by_pandas),
        ("pandas, tuples, the paper's law", rows_by_lists),
        ("pandas, iterrows, the split filter", filter_each_sample),
    ):
        seconds = best(lambda way=way: [way(job.table, p) for p in paths[:3]], 3) / 3
        print(f"{name:<52}{1e3 * seconds:8.2f} ms a log {seconds / ours:8.1f} x")
    log = read_log(paths[0])
    print(f"  of it reading {'':<36}{1e3 * best(lambda: read_log(paths[0]), 20):8.2f} ms")
    alone = best(lambda: estimator.estimate(job.table, log, with_laws=False), 20)
    print(f"  of it estimating {'':<33}{1e3 * alone:8.2f} ms")


def whole_batches(job: Job, folder: Path, work: Path, count: int) -> None:
    """Batches with journal and results on one and two worker processes, turn by turn."""
    pools = {n: Pool(n) for n in (1, 2)}
    times: dict[int, list[float]] = {1: [], 2: []}
    own = time.process_time()
    for n, pool in pools.items():  # the workers' imports are no part of it
        run_batch(job, [str(folder / "car_00000[0-9].csv")], work / f"warm_{n}", pool)
    for turn in range(REPEAT):
        for n, pool in pools.items():
            start = time.perf_counter()
            run_batch(job, [str(folder)], work / f"out_{n}_{turn}", pool)
            times[n].append(time.perf_counter() - start)
    for n, pool in pools.items():
        said = f"batch of {count} with journal, {n} worker{'s' * (n > 1)}"
        print(f"{said:<52}{'':<18}{count / min(times[n]):8.1f} logs/s")
        pool.close()
    own = (time.process_time() - own) / (2 * REPEAT * count + 20)
    print(f"{'this process itself':<52}{1e3 * own:8.2f} ms a log")
    print(
        f"scaling on two cores {min(times[1]) / min(times[2]):.2f} (load of the machine "
        f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} cores)"
    )
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory of this process {peak:.0f} MB; of workers see tests/studies/fleet_cost.py")


if __name__ == "__main__":
    main()
