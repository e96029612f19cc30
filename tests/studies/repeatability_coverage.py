"""How often the 95 % intervals of a gauge study hold the truth, for designs good and poor.

    python tests/studies/repeatability_coverage.py [--studies 400] [--seed 1]

Components are known: the figure is drawn, not fitted. Prints for each design, in percent, how often
the interval of each component, of %GRR and of ndc holds the truth.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.line.gauge.gauge_rr import (
    CAR,
    GAUGE,
    INTERACTION,
    NDC,
    REPEATABILITY,
    STATION,
    TOTAL,
    anova,
    gauge_rr,
    terms_of,
)

GAUGES = {
    # standard deviations of car, station, car by station, repeat
    "good": (1.0, 0.05, 0.03, 0.05),
    "marginal": (1.0, 0.15, 0.08, 0.15),
    "bad": (1.0, 0.6, 0.3, 0.6),
    "no interaction": (1.0, 0.2, 0.0, 0.2),
}
DESIGNS = {
    # cars, stations, repeats, share of ramps lost
    "10 x 3 x 3": (10, 3, 3, 0.0),
    "10 x 3 x 2, 20 % lost": (10, 3, 2, 0.2),
    "5 x 2 x 2": (5, 2, 2, 0.0),
    "6 x 4 x 3, 35 % lost": (6, 4, 3, 0.35),
    "10 x 3, one way": (10, 1, 3, 0.0),
    "10 x 3, one way, 30 % lost": (10, 1, 3, 0.3),
    "10 x 3 x 1": (10, 3, 1, 0.0),
    "3 x 2 x 2": (3, 2, 2, 0.0),
}
NAMES = (REPEATABILITY, STATION, INTERACTION, GAUGE, CAR, TOTAL)


def truth_of(sd, terms):
    """Variances by name; what the design cannot tell from the repeat is in the repeat."""
    car, station, both, repeat = np.square(sd)
    if STATION not in terms:
        station = both = 0.0
    if INTERACTION not in terms:
        repeat, both = repeat + both, 0.0
    total = car + station + both + repeat
    return {REPEATABILITY: repeat, STATION: station, INTERACTION: both, CAR: car, TOTAL: total} | {
        GAUGE: total - car
    }


def drawn(rng, design, sd):
    cars, stations, repeats, lost = design
    car, station, _ = (x.ravel() for x in np.indices((cars, stations, repeats)))
    while True:
        keep = rng.random(car.size) >= lost
        if len(set(car[keep])) == cars and keep.sum() > cars * stations * 0.5 + stations + 1:
            break
    y = sd[0] * rng.normal(size=cars)[car] + sd[3] * rng.normal(size=car.size)
    if stations > 1:
        y += sd[1] * rng.normal(size=stations)[station]
        y += sd[2] * rng.normal(size=(cars, stations))[car, station]
    return y[keep], car[keep], station[keep]


def coverage(rng, design, sd, studies):
    held = {name: [] for name in (*NAMES, "%GRR", "ndc")}
    for _ in range(studies):
        y, car, station = drawn(rng, design, sd)
        terms = terms_of(car, station)
        found, truth = gauge_rr(anova(y, car, station, terms)), truth_of(sd, terms)
        for name in NAMES:
            if name in found.components:
                c = found.components[name]
                held[name].append(c.low <= truth[name] <= c.high)
        grr = np.sqrt(truth[GAUGE] / truth[TOTAL])
        ndc = NDC * np.sqrt(truth[CAR] / truth[GAUGE])
        held["%GRR"].append(found.grr95[0] <= grr <= found.grr95[1])
        held["ndc"].append(found.ndc95[0] <= ndc <= found.ndc95[1])
    return {name: np.mean(hits) if hits else np.nan for name, hits in held.items()}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--studies", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args()
    columns = ("EV", "station", "both", "GRR", "PV", "TV", "%GRR", "ndc")
    print(f"{told.studies} studies each, seed {told.seed}; percent of intervals with the truth")
    print(f"{'design':<28}{'gauge':<16}" + "".join(f"{c:>9}" for c in columns))
    for i, (design, shape) in enumerate(DESIGNS.items()):
        for j, (name, sd) in enumerate(GAUGES.items()):
            rng = np.random.default_rng([told.seed, i, j])
            found = coverage(rng, shape, sd, told.studies)
            cells = "".join(
                f"{100 * v:9.1f}" if np.isfinite(v) else f"{'':>9}" for v in found.values()
            )
            print(f"{design:<28}{name:<16}{cells}", flush=True)


if __name__ == "__main__":
    main()
