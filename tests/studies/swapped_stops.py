"""Swapped wheel speeds on cars of any balance: how many stops pass without a word?

    python tests/studies/swapped_stops.py [--cars 12] [--seed 1]

Cars of `ensemble`, with rear pistons such that both axles brake as hard for their load at 0.25 to
0.8 g. Each has a ramp, a coast log and stops at 0.25, 0.35 and 0.45 g with pads as on the ramp, at
0.3 g with front or rear pads at 0.8, and with front pads at 0.6. The first three are judged as they
are and with front and rear wheel speeds swapped, all with and without the reference speed. A stop
is refused; invalid, with a warning of the swap and no valid sample; named, with such a warning;
warned, of something else; or silent. Of silent stops the coverage counts: the share of valid
samples whose interval holds the truth.
"""

import argparse
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError, LogError
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.table.table import Table
from tests.studies.against_truth import against_truth, mean, truths_of
from tests.studies.coverage import without_v
from tests.studies.fast_pedal import Levels, drawn, ramp_and_coast, rising, run
from tests.support.balanced import balanced
from tests.support.plant import Plant, per_pascal
from tests.support.reference_car import swapped

AS_ON_THE_RAMP = ((0.25, 1.0, 1.0), (0.35, 1.0, 1.0), (0.45, 1.0, 1.0))
CHANGED = ((0.3, 0.8, 1.0), (0.3, 1.0, 0.8), (0.3, 0.6, 1.0))
"""Deceleration aimed at [g], front and rear pads over those of the ramp."""

REFUSED, INVALID, NAMED, WARNED, SILENT = "refused", "invalid", "named", "warned", "silent"


def logs_of(plant: Plant, levels: Levels) -> tuple[list[Log], Iterator[tuple[str, Log]]]:
    """Ramp and coast; and what is done to each stop, with it."""
    return ramp_and_coast(plant, levels, 0.55), stops(plant, levels)


def stops(plant: Plant, levels: Levels) -> Iterator[tuple[str, Log]]:
    """Every stop with its name, the swapped ones among them."""
    mu = [axle.pad_friction for axle in (plant.vehicle.front, plant.vehicle.rear)]
    for k, (aim, front, rear) in enumerate((*AS_ON_THE_RAMP, *CHANGED)):
        pads = (front * mu[0], rear * mu[1])
        on = replace(plant, pads=lambda t, pads=pads: pads)
        pressure = rising(60.0, aim / per_pascal(plant.vehicle))
        log = run(on, levels, pressure, 27.0, 10 + k, duration=8.0, stop_speed=1.5)
        if front == rear:
            yield f"swapped, {aim:g} g", swapped(log)
            yield f"as it is, {aim:g} g", log
        else:
            yield f"pads {front:g} / {rear:g}", log


def judged(table: Table, log: Log) -> tuple[str, tuple[float, float] | None]:
    """What a validation makes of a stop, and its coverage front and rear."""
    try:
        result = validate_one(table, log, None, DEFAULTS, baselines=False)
    except LogError:
        return REFUSED, None
    front, rear = against_truth(result.estimate, truths_of(log))
    codes = {warning.code for warning in result.warnings}
    word = WARNED if codes else SILENT
    if "axles_exchanged" in codes:
        word = NAMED if front.held.size else INVALID
    return word, (mean(front.held), mean(rear.held))


def main() -> None:
    """Print how often each kind of stop is refused, invalid, named or silent."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cars", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    words: dict[tuple[str, str], Counter[str]] = defaultdict(Counter)
    covered: dict[tuple[str, str], list[tuple[float, float]]] = defaultdict(list)
    for number in range(asked.cars):
        plant, levels = drawn(asked.seed, number)
        z = float(np.random.default_rng([asked.seed, number, 1]).uniform(0.25, 0.8))
        plant = replace(plant, vehicle=balanced(plant.vehicle, z))
        of_fit, made = logs_of(plant, levels)
        held_out = list(made)
        for told, less in (("with v", lambda log: log), ("without v", without_v)):
            try:
                table = fit(plant.vehicle, [less(log) for log in of_fit])
            except BrakeCalError as error:
                words["refused by fit", told][str(error).split(": ")[1][:60]] += 1
                continue
            for name, log in held_out:
                word, share = judged(table, less(log))
                words[name, told][word] += 1
                if word == SILENT and share is not None and np.isfinite(share[0]):
                    covered[name, told].append(share)
    print(f"{asked.cars} cars, seed {asked.seed}")
    for (name, told), counted in sorted(words.items()):
        least = np.min(covered[name, told], axis=0) if covered[name, told] else ()
        lowest = " / ".join(f"{share:.2f}" for share in least)
        said = ", ".join(f"{word} {n}" for word, n in counted.most_common())
        print(f"{name:20} {told:10} {said:44} {'lowest silent ' + lowest if lowest else ''}")


if __name__ == "__main__":
    main()
