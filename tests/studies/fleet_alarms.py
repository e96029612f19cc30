"""How often a fleet of good cars names one, and how often a bad car is found.

    python tests/studies/fleet_alarms.py [FLEETS [METRIC...]]

Fleets (400 unless told otherwise) of 12, 60 and 300 cars with 1 and 12 metrics, drawn with a fixed
seed. Every metric of a fleet has the distribution of its row; `mixed` has one metric with long
tails among normal ones, `correlated` twelve that follow three. A page alarms if it names a car or a
drift. A bad car is off by 5 standard deviations in one metric (in `correlated` in four).
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.fleet.control_chart import change, least_p
from calib.fleet.outliers import judge, named
from calib.fleet.summary import DRIFT

SEED = 20


def normal(rng, m, n):
    return rng.normal(size=(m, n))


def long_tails(rng, m, n):
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
    x = rng.normal(size=(m, n))
    x[-1] = rng.standard_t(4, size=n) / np.sqrt(2.0)
    return x


def alarms(values):
    """Whether the cars and the drift of a fleet alarm."""
    cars = bool(judge(values).named.any())
    found = [change(x) for x in values]
    enough = DRIFT / max(sum(c is not None for c in found), 1)
    p = [c.p if c and least_p(values.shape[1]) <= enough else np.nan for c in found]
    return cars, cars or bool(named(np.array(p), DRIFT).any())


def with_bad_car(values, draw):
    """The fleet with its first car off by 5 standard deviations."""
    out = values.copy()
    rows = min(4, len(out)) if draw is correlated else 1
    sigma = np.std(out[:rows], axis=1)
    out[:rows, 0] = out[:rows, 0] + 5.0 * sigma
    return out


DRAWN = (normal, long_tails, skewed, exponential, rounded, nominal, shrunk, correlated, mixed)


def main() -> None:
    """Print a line for each setting."""
    fleets = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    print(f"{'metric':<12} {'cars':>5} {'metrics':>7} {'cars named':>11} {'page':>7} {'found':>7}")
    for draw in DRAWN:
        if sys.argv[2:] and draw.__name__ not in sys.argv[2:]:
            continue
        for n, m in ((60, 12), (60, 1), (12, 1), (12, 12), (300, 1), (300, 12)):
            rng = np.random.default_rng([SEED, n, m])
            seen = [alarms(draw(rng, m, n)) for _ in range(fleets)]
            hits = [
                judge(with_bad_car(draw(rng, m, n), draw)).named[:, 0].any()
                for _ in range(fleets // 2)
            ]
            cars, page = 100.0 * np.mean(seen, axis=0)
            print(
                f"{draw.__name__:<12} {n:5d} {m:7d} {cars:9.1f} % {page:5.1f} % "
                f"{100.0 * np.mean(hits):5.0f} %",
                flush=True,
            )


if __name__ == "__main__":
    main()
