"""How often the 95 % intervals hold the truth, and how large the errors are, on random cars.

    python tests/studies/coverage.py --cars 150 --seed 2

One table per surface; pooled figures with 95 % limits from resampling the cars. `--no-v` leaves the
reference speed out of ramp and stop. The errors within a log are one error seen many times, so the
limits count cars, not samples.
"""

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.estimation.estimator import Estimate, estimate
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.table.table import Table
from tests.studies.against_truth import against_truth, mean, truths_of
from tests.studies.ensemble import SURFACES, Case, cases

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
    held: tuple[float, float]
    bias: tuple[float, float]
    width: tuple[float, float]
    rms: dict[str, tuple[float, float]]


def without_v(log: Log) -> Log:
    """The log as a car without a reference speed writes it."""
    return replace(log, channels={k: v for k, v in log.channels.items() if k != "v"})


def rows_of(index: int, case: Case, keep_v: bool) -> list[Row]:
    """Fit the ramp of a car, run its stops."""
    table = fit(case.vehicle, [case.ramp if keep_v else without_v(case.ramp)])
    return [
        row(index, table, stop.log if keep_v else without_v(stop.log), stop.surface, stop.alike)
        for stop in case.stops
    ]


def row(index: int, table: Table, log: Log, surface: str, alike: bool) -> Row:
    """Score one stop against the plant."""
    e = estimate(table, log)
    valid, counted = e.valid, e.braked & (e.speed > 3.0)
    truths = truths_of(log)
    if not valid.any():
        nan = (np.nan, np.nan)
        return Row(index, surface, alike, 0.0, 0, nan, nan, nan, {})

    front, rear = against_truth(e, truths)
    return Row(
        car=index,
        surface=surface,
        alike=alike,
        valid_share=float(np.sum(valid & counted) / np.sum(counted)),
        samples=int(valid.sum()),
        held=(mean(front.held), mean(rear.held)),
        bias=(mean(front.error), mean(rear.error)),
        width=(float(np.median(front.half_width)), float(np.median(rear.half_width))),
        rms=method_errors(e, truths),
    )


def method_errors(
    e: Estimate, truths: tuple[np.ndarray, np.ndarray]
) -> dict[str, tuple[float, float]]:
    """Rms relative error of each method over the valid samples, front and rear [1]."""
    pads = {"kalman": (e.front.pad_friction, e.rear.pad_friction), **e.baselines}
    return {
        name: tuple(
            float(np.sqrt(np.mean((mu / t - 1.0)[e.valid] ** 2)))
            for mu, t in zip(pads[name], truths, strict=True)
        )
        for name in METHODS
    }


def pooled(rows: list[Row]) -> float:
    """Share of valid samples whose interval holds the truth, both axles."""
    weight = np.array([r.samples for r in rows], float)
    held = np.array([np.mean(r.held) if r.samples else 0.0 for r in rows])
    return float(weight @ held / weight.sum())


def limits(rows: list[Row], seed: int, draws: int = 1000) -> tuple[float, float]:
    """95 % limits of `pooled` by resampling cars."""
    by_car: dict[int, list[Row]] = {}
    for r in rows:
        by_car.setdefault(r.car, []).append(r)
    rng, names = np.random.default_rng(seed), list(by_car)
    values = [
        pooled([r for car in rng.choice(names, len(names)) for r in by_car[car]])
        for _ in range(draws)
    ]
    low, high = np.percentile(values, [2.5, 97.5])
    return float(low), float(high)


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
                share = np.mean([r.valid_share for r in part])
                bias, width = pair([r.bias for r in part]), pair([r.width for r in part])
                print(f"{surface:<8} {'alike' if alike else 'differing':<9} {len(part):5d} "
                      f"{share:6.2f} {pooled(part):12.3f} {bias:>12} {width:>13}")  # fmt: skip
    print("\nmedian rms error of the pad friction, front / rear %")
    for name in METHODS:
        errors = np.array([r.rms[name] for r in rows if r.rms])
        f, b = 100 * np.median(errors, axis=0)
        print(f"{name:<20} {f:6.1f} / {b:5.1f}")


def pair(values: list[tuple[float, float]]) -> str:
    """Mean size of front and rear in percent."""
    f, r = 100 * np.mean(np.abs(values), axis=0)
    return f"{f:.1f} / {r:.1f}"


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cars", type=int, default=150)
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--no-v", action="store_true")
    wanted = parser.parse_args()
    rows = [
        r
        for i, case in enumerate(cases(wanted.cars, wanted.seed))
        for r in rows_of(i, case, not wanted.no_v)
    ]
    print(f"{wanted.cars} cars, seed {wanted.seed}, {'without' if wanted.no_v else 'with'} v")
    report(rows, wanted.seed)


if __name__ == "__main__":
    main()
