"""How often the 95 % intervals hold the truth, and how large the errors are, on random cars.

    python tests/studies/coverage.py --cars 150 --seed 2 [--no-v] [--jobs 2]

One row per surface; the pooled share with 95 % limits from resampling the cars, since the errors
within a log are one error seen many times. `--no-v` leaves the reference speed out.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.estimation.estimator import Estimate, estimate
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.table.table import Table
from tests.studies.ensemble import SURFACES, case
from tests.studies.study import AgainstTruth, arguments, carried_out, pair
from tests.support.reference_car import without

METHODS = ("kalman", "nominal", "mean_gain", "temperature", "gradient_as_written", "gradient_paper")
METHODS += ("rls_paper", "rls_difference", "rls_tyre")


@dataclass(frozen=True)
class Row:
    """One stop: where, how long valid, what share holds the truth, errors and widths [1]."""

    car: int
    surface: str
    alike: bool
    valid_share: float
    samples: int
    found: np.ndarray
    """Share in the interval, bias and median half width, by axle, (3, 2)."""
    rms: dict[str, np.ndarray]


def tried(job: tuple[int, int, bool]) -> list[Row]:
    """Fit the ramp of a car, run its stops: (seed, car, whether it has v)."""
    seed, number, keep_v = job
    of = case(np.random.default_rng([seed, number]), 3, seed * 1000 + number)
    table = fit(of.vehicle, [of.ramp if keep_v else without(of.ramp, "v")])
    logs = [stop.log if keep_v else without(stop.log, "v") for stop in of.stops]
    return [
        row(number, table, log, stop.surface, stop.alike)
        for log, stop in zip(logs, of.stops, strict=True)
    ]


def row(car: int, table: Table, log: Log, surface: str, alike: bool) -> Row:
    """Score one stop against the plant."""
    e = estimate(table, log)
    counted = e.braked & (e.speed > 3.0)
    if not e.valid.any():
        return Row(car, surface, alike, 0.0, 0, np.full((3, 2), np.nan), {})
    against = AgainstTruth.of(e, log)
    found = (against.held.mean(axis=1), against.error.mean(axis=1))
    found += (np.median(against.half_width, axis=1),)
    part = float(np.sum(e.valid & counted) / np.sum(counted))
    return Row(
        car, surface, alike, part, int(e.valid.sum()), np.array(found), method_errors(e, log)
    )


def method_errors(e: Estimate, log: Log) -> dict[str, np.ndarray]:
    """Rms relative error of each method over the valid samples, front and rear [1]."""
    pads = {"kalman": (e.best.pads_f.value, e.best.pads_r.value), **e.baselines}
    truth = np.array([log.truth["true_mu_pad_f"], log.truth["true_mu_pad_r"]])
    errors = {name: (np.array(pads[name]) / truth - 1.0)[:, e.valid] for name in METHODS}
    return {name: np.sqrt(np.mean(error**2, axis=1)) for name, error in errors.items()}


def pooled(rows: list[Row]) -> float:
    """Share of valid samples whose interval holds the truth, both axles."""
    weights = [r.samples for r in rows]
    return float(
        np.average([r.found[0].mean() if r.samples else 0.0 for r in rows], weights=weights)
    )


def limits(rows: list[Row], seed: int, draws: int = 1000) -> np.ndarray:
    """95 % limits of `pooled` by resampling cars."""
    by_car: dict[int, list[Row]] = {}
    for r in rows:
        by_car.setdefault(r.car, []).append(r)
    rng, names = np.random.default_rng(seed), list(by_car)
    drawn = (rng.choice(names, len(names)) for _ in range(draws))
    return np.percentile(
        [pooled([r for c in cars for r in by_car[c]]) for cars in drawn], [2.5, 97.5]
    )


def report(rows: list[Row], seed: int) -> None:
    """Print the tables."""
    low, high = limits(rows, seed)
    print(f"truth in the 95 % interval: {pooled(rows):.3f} of valid samples ({low:.3f}-{high:.3f})")
    print(
        f"valid share of braked samples above 3 m/s: {np.mean([r.valid_share for r in rows]):.2f}"
    )
    print(f"\n{'surface':<8} {'pads':<9} {'stops':>5} {'valid':>6} {'in interval':>12} "
          f"{'|bias| %':>12} {'half width %':>13}")  # fmt: skip
    for surface in SURFACES:
        for alike in (True, False):
            part = [r for r in rows if (r.surface, r.alike) == (surface, alike) and r.samples]
            if part:
                valid = np.mean([r.valid_share for r in part])
                _, bias, width = 100 * np.mean([np.abs(r.found) for r in part], axis=0)
                print(f"{surface:<8} {'alike' if alike else 'differing':<9} {len(part):5d} "
                      f"{valid:6.2f} {pooled(part):12.3f} {pair(bias, '.1f'):>12} "
                      f"{pair(width, '.1f'):>13}")  # fmt: skip
    print("\nmedian rms error of the pad friction, front / rear %")
    for name in METHODS:
        errors = [r.rms[name] for r in rows if r.rms]
        print(f"{name:<20} {pair(100 * np.median(errors, axis=0), '6.1f')}")


def main() -> None:
    """Run the study."""
    asked = arguments(__doc__, "no_v", cars=150, seed=2, jobs=1)
    jobs = [(asked.seed, i, not asked.no_v) for i in range(asked.cars)]
    report([r for rows in carried_out(tried, jobs, asked.jobs) for r in rows], asked.seed)


if __name__ == "__main__":
    main()
