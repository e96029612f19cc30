"""Golden tables made of several cars: is the mean where it says, is a sigma of the fleet a sigma?

    python tests/studies/golden.py [--models 10] [--cars 24] [--fleets 20000] [--seed 1] [--jobs 2]

First numbers alone: fleets drawn from a normal distribution, each car measured with an error of its
own. How often does the 95 % interval of the mean hold the true mean, and how often is one more car
within 1.96 and 3 sigma? Beside it what DerSimonian and Laird's normal interval would do.

Then whole tables: cars of models drawn as in `station_verdicts`, each with ramp and coast through
the plant and `fit`. Of the cars of a model some are merged, and the others are judged by the golden
table: good ones, and ones with a fault. Cars are judged by many golden tables, so limits come from
resampling models.
"""

import argparse
import sys
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.base.random_effects import as_sigma, random_effects
from calib.line.station.fleet_sigma import FleetSigma, fleet_sigma
from calib.line.station.identity import Identity
from calib.line.station.station import table_of
from calib.store.merge import merge
from calib.store.version import Stored
from calib.table.table import Table
from tests.studies.station_verdicts import Build, Model, model, ramp_and_coast, scaled, scattered

SIZES = (2, 3, 5, 10)
"""Cars of a golden table."""

RATIOS = (0.0, 0.5, 1.0, 3.0)
"""Standard deviation between cars over that of one measurement, in the fleets of numbers."""

REPEATS = 6
"""Golden tables of each size that are made of the cars of one model."""

FIGURES = ("D", "pad_level", "pad_ratio", "stiffness")

FAULTS = {
    "good": lambda b: b,
    "pads 15 % weak, both axles": scaled("pads", 0.85, 0.85),
    "rear pads 25 % weak": scaled("pads", 1.0, 0.75),
    "tyres 20 % softer": lambda b: replace(b, stiffness=0.8 * b.stiffness),
}


def of_numbers(fleets: int, seed: int) -> None:
    """Print the coverage for fleets of numbers."""
    rng = np.random.default_rng(seed)
    print(f"fleets of numbers: {fleets} each, seed {seed}, measuring errors within a factor of 2")
    print(f"{'cars':>4} {'between':>8}   {'mean in 95 %':>12} {'normal, DL':>11}   "
          f"{'within 1.96':>11} {'within 3':>9}")  # fmt: skip
    for k in SIZES:
        for ratio in RATIOS:
            v = rng.uniform(0.5, 2.0, (k, fleets))
            x = rng.normal(0.0, np.sqrt(ratio**2 + v))
            found = random_effects(x, v)
            held = np.abs(found.mean) <= found.half_width
            own = rng.uniform(0.5, 2.0, fleets)
            car = rng.normal(0.0, np.sqrt(ratio**2 + own))
            t = (car - found.mean) / np.sqrt(found.between + found.sigma**2 + own)
            sigma = np.array([abs(as_sigma(float(one), found.freedom)) for one in t])
            within = [sigma < limit for limit in (1.96, 3.0)]
            a, b, c, d = (100.0 * hits.mean() for hits in (held, _normal(x, v), *within))
            print(f"{k:4d} {ratio:8.1f}   {a:10.1f} % {b:9.1f} %   {c:9.1f} % {d:7.2f} %")


def _normal(x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Whether the normal interval of DerSimonian and Laird holds zero, their (8) to (10)."""
    w = 1.0 / v
    mean = (w * x).sum(axis=0) / w.sum(axis=0)
    Q = (w * (x - mean) ** 2).sum(axis=0)
    c = w.sum(axis=0) - (w**2).sum(axis=0) / w.sum(axis=0)
    star = 1.0 / (v + np.maximum(0.0, (Q - (x.shape[0] - 1)) / c))
    return np.abs((star * x).sum(axis=0)) <= 1.96 * np.sqrt(star.sum(axis=0))


def table_for(of: Model, build: Build, seed: int, serial: str) -> Table:
    """The table of one car."""
    ramp, coast = ramp_and_coast(of, build, seed)
    return table_of(of.vehicle, [ramp], [coast], Identity(serial=serial))


def of_one_model(job: tuple[int, int, int]) -> list[tuple[int, str, FleetSigma, bool, bool]]:
    """Cars in golden tables of one model: size, kind, sigma, true pads in the table's bands."""
    seed, number, cars = job
    rng = np.random.default_rng([seed, number])
    of = model(rng)
    first = 10_000 * number + 1_000_000 * seed
    kinds = ["good"] * cars + [kind for kind in FAULTS if kind != "good" for _ in range(4)]
    made = []
    for k, kind in enumerate(kinds):
        build = FAULTS[kind](scattered(rng))
        try:
            made.append((kind, build, table_for(of, build, first + 10 * k, f"{number}-{k}")))
        except BrakeCalError as error:
            print(f"refused, {kind}: {error}", file=sys.stderr)
    good = [i for i, (kind, _, _) in enumerate(made) if kind == "good"]
    out = []
    for size in SIZES:
        for _ in range(REPEATS):
            parents = rng.choice(good, size, replace=False).tolist()
            golden = merge([stored(made[i][2], i) for i in parents], "golden")
            for i, (kind, build, table) in enumerate(made):
                if i not in parents:
                    held = pads_held(golden, of, build)
                    out.append((size, kind, fleet_sigma(table, golden), *held))
    return out


def stored(table: Table, number: int) -> Stored:
    """A table as if it came out of a store."""
    return Stored(table, table.name, number + 1, table.digest, Path())


def pads_held(golden: Table, of: Model, build: Build) -> tuple[bool, bool]:
    """Whether the true pads of a car are in the 95 % intervals of the golden table."""
    cal, car = golden.calibration, of.vehicle
    pairs = (
        (cal.pad_friction_f.ci95, car.front.pad_friction * build.pads[0]),
        (cal.pad_friction_r.ci95, car.rear.pad_friction * build.pads[1]),
    )
    front, rear = (low <= true <= high for (low, high), true in pairs)
    return front, rear


def report(of_models: list[list[tuple[int, str, FleetSigma, bool, bool]]]) -> None:
    """Print the tables of whole cars."""
    found: dict[tuple[int, str, str, float], list[list[bool]]] = defaultdict(list)
    pads: dict[tuple[int, int], list[list[bool]]] = defaultdict(list)
    for rows in of_models:
        for size in SIZES:
            for kind in FAULTS:
                part = [r for r in rows if r[:2] == (size, kind)]
                for figure in FIGURES:
                    sigma = [s for r in part if (s := getattr(r[2], figure)) is not None]
                    for limit in (1.96, 3.0):
                        found[size, kind, figure, limit].append([abs(s) < limit for s in sigma])
            good = [r for r in rows if r[:2] == (size, "good")]
            for axle in (0, 1):
                pads[size, axle].append([r[3 + axle] for r in good])
    for limit in (1.96, 3.0):
        print(f"\nwithin {limit:g} sigma of the fleet, percent (95 % limits, models resampled)")
        print(f"{'kind':<28} {'cars':>4}  " + "".join(f"{f:>22}" for f in FIGURES))
        for kind in FAULTS:
            for size in SIZES:
                shown = [percent(found[size, kind, figure, limit]) for figure in FIGURES]
                print(f"{kind:<28} {size:4d}  " + "".join(f"{s:>22}" for s in shown))
    print("\ntrue pads of a good car in the 95 % interval of the golden table, front and rear")
    for size in SIZES:
        print(f"{size:4d} cars  {percent(pads[size, 0])}, {percent(pads[size, 1])}")


def percent(of_models: list[list[bool]]) -> str:
    """A share with 95 % limits from resampling models."""
    rng = np.random.default_rng(0)
    hits = np.array([sum(one) for one in of_models], dtype=float)
    counts = np.array([len(one) for one in of_models], dtype=float)
    drawn = rng.integers(0, hits.size, (2000, hits.size))
    shares = 100.0 * hits[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    low, high = np.percentile(shares, [2.5, 97.5])
    return f"{100.0 * hits.sum() / counts.sum():.1f} ({low:.0f}-{high:.0f})"


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--models", type=int, default=10)
    parser.add_argument("--cars", type=int, default=24, help="good cars of each model")
    parser.add_argument("--fleets", type=int, default=20000, help="fleets of numbers")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    asked = parser.parse_args()
    of_numbers(asked.fleets, asked.seed)
    jobs = [(asked.seed, i, asked.cars) for i in range(asked.models)]
    with ProcessPoolExecutor(asked.jobs) as pool:
        found = list(pool.map(of_one_model, jobs))
    print(f"\nwhole tables: {asked.models} models, {asked.cars} good cars each, seed {asked.seed}")
    report(found)


if __name__ == "__main__":
    main()
