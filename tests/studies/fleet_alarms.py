"""How often the page of a fleet of good cars calls one apart, and how often a bad car is found.

    python tests/studies/fleet_alarms.py [FLEETS [DISTRIBUTION...]]

FLEETS (80 unless told otherwise) of 12, 60 and 300 cars with 1 metric, half as many with 12
metrics, a quarter as many of 300 cars with 12; drawn with a fixed seed for each setting. Every
metric of a fleet has the distribution of its row. A page alarms if it names a car or a drift. A bad
car is one of the fleet, moved by 5, 7 or 10 standard deviations of the distribution in one metric
(in `correlated` in four); half as many fleets of each size, for the distributions in `FOUND`.
Prints the rows of the two tables in `results/fleet_alarms.md`.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.line.fleet.outliers import judge
from calib.line.fleet.summary import drifting

SEED = 20
CARS, METRICS, SIZES = (12, 60, 300), (1, 12), (5.0, 7.0, 10.0)


def normal(rng, m, n):
    return rng.normal(size=(m, n))


def long_tails(rng, m, n):
    """Student's t with 4 degrees of freedom."""
    return rng.standard_t(4, size=(m, n)) / np.sqrt(2.0)


def skewed(rng, m, n):
    return np.exp(0.5 * rng.normal(size=(m, n))) / 0.604


def exponential(rng, m, n):
    return rng.exponential(size=(m, n))


def rounded(rng, m, n):
    """Whole numbers: most cars share a value with others."""
    return np.round(2.0 * rng.normal(size=(m, n))) / 2.0


def nominal(rng, m, n):
    """Six of ten cars at the nominal value but for a millionth, the others scattered about it."""
    x = rng.normal(size=(m, n))
    return np.where(rng.random((m, n)) < 0.6, 1e-6 * x, x)


def shrunk(rng, m, n):
    """Each car drawn to the nominal value by a weight of its own."""
    return rng.normal(size=(m, n)) * (1.0 - rng.beta(4.0, 1.0, size=(m, n))) * 3.6


def correlated(rng, m, n):
    """Three things in twelve metrics: each four follow one (correlation 0.94)."""
    x = np.repeat(rng.normal(size=(max(1, m // 4), n)), 4, axis=0)[:m]
    return x + 0.25 * rng.normal(size=(m, n))


def mixed(rng, m, n):
    """One metric with long tails; the others are normal."""
    x = rng.normal(size=(m, n))
    x[-1] = rng.standard_t(4, size=n) / np.sqrt(2.0)
    return x


def models(rng, m, n):
    """Two models in one fleet, 20 to 50 % of the second, up to 8 sigma apart in each metric."""
    second = rng.permutation(n) < rng.uniform(0.2, 0.5) * n
    return rng.normal(size=(m, n)) + second * rng.uniform(0.0, 8.0, size=(m, 1))


def repeated(rng, m, n):
    """Four logs of each car, one after the other; 80 % of the variance is that of the cars."""
    cars = np.repeat(rng.normal(size=(m, -(-n // 4))), 4, axis=1)[:, :n]
    return np.sqrt(0.8) * cars + np.sqrt(0.2) * rng.normal(size=(m, n))


DRAWN = (
    normal,
    long_tails,
    mixed,
    skewed,
    exponential,
    correlated,
    rounded,
    nominal,
    shrunk,
    models,
    repeated,
)


def alarms(values):
    """Whether the page of a fleet, (m, n), calls any car apart or any drift."""
    return bool(judge(values).named.any() or any(drifting(values)[1]))


def with_bad_car(values, draw, size, sigma):
    """The fleet with its first car off by ``size`` times ``sigma``."""
    out = values.copy()
    out[: min(4, len(out)) if draw is correlated else 1, 0] += size * sigma
    return out


def good(draw, n, m, fleets):
    """Share of alarms of good fleets [%]."""
    rng = np.random.default_rng([SEED, n, m])
    return f"{100.0 * np.mean([alarms(draw(rng, m, n)) for _ in range(fleets)]):.1f}"


def bad(draw, n, m, fleets):
    """Share of bad cars that are found, by size [%]."""
    rng = np.random.default_rng([SEED, n, m, 1])
    sigma = float(np.std(draw(rng, 1, 100_000)))
    found = [
        np.mean(
            [
                judge(with_bad_car(draw(rng, m, n), draw, size, sigma)).named[:, 0].any()
                for _ in range(fleets // 2)
            ]
        )
        for size in SIZES
    ]
    return ", ".join(f"{100.0 * share:.0f}" for share in found)


FEWER = {(12, 12): 2, (60, 12): 2, (300, 12): 4}
FOUND = (normal, correlated, long_tails)


def main() -> None:
    """Print a row of each table for each distribution."""
    fleets = int(sys.argv[1]) if len(sys.argv) > 1 else 80
    for draw in DRAWN:
        if sys.argv[2:] and draw.__name__ not in sys.argv[2:]:
            continue
        for told in (good, bad) if draw in FOUND else (good,):
            row = [
                "; ".join(told(draw, n, m, fleets // FEWER.get((n, m), 1)) for m in METRICS)
                for n in CARS
            ]
            print(f"{told.__name__:<4} | {draw.__name__} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
