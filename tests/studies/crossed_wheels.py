"""Wheel speeds of one front and one rear wheel exchanged: are they named, and what else is?

    python tests/studies/crossed_wheels.py [--cars 12] [--seed 82] [--validate]

Each car of an independent plant stops three times, as it is and with what might look like exchanged
columns: brakes that differ from wheel to wheel, one caliper without pressure or at a half, one that
drags, unlike tyres, bends, a wet road, weak front pads. Of the stop as it is, every front column is
exchanged with every rear one. The table's E is that of the stop as it is. With `--validate` each
car gets a table from its ramp, and the stops go through the whole validation.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import LogError
from calib.base.names import WHEELS
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.run.driving_record import driving_record
from calib.run.wheels import crossed_diagonal, crossed_side, wheel_parts
from calib.table.table import Table
from tests.studies.made_lines import Line, Run, line, recorded
from tests.support.balanced import balanced
from tests.support.plant import magic

PAIRS = (("fl", "rl"), ("fr", "rr"), ("fl", "rr"), ("fr", "rl"))


def with_brakes(run: Run, **shares: float) -> Run:
    """The run with shares of the pressure [1] at some wheels."""
    wheels = {w: (lambda t, s=share: s * run.pressure(t)) for w, share in shares.items()}
    return replace(run, wheels=wheels)


def with_plant(run: Run, **changes: object) -> Run:
    return replace(run, plant=replace(run.plant, **changes))


def in_bend(run: Run, radius: float, start: float) -> Run:
    """The run in a bend [m] from a time [s] on."""
    return with_plant(run, curvature=lambda t: (t >= start) / radius)


def weak_front(run: Run) -> Run:
    of = run.plant.vehicle
    front, rear = of.front.pad_friction, of.rear.pad_friction
    return with_plant(run, pads=lambda t: (0.65 * front, rear))


def variants(run: Run, rng: np.random.Generator) -> Iterator[tuple[str, Run]]:
    """What a stop without exchanged columns may be."""
    yield "as it is", run
    for sd in (0.03, 0.08):
        shares = {w: float(np.exp(rng.normal(0.0, sd))) for w in WHEELS}
        yield f"brakes differ by {100 * sd:.0f} %", with_brakes(run, **shares)
    wheel = str(rng.choice(WHEELS))
    yield "one caliper without pressure", with_brakes(run, **{wheel: 0.0})
    yield "one caliper at a half", with_brakes(run, **{wheel: 0.5})
    yield "left brakes 10 % stronger", with_brakes(run, fl=1.1, rl=1.1)
    drags = replace(run, wheels={"rl": lambda t: run.pressure(t) + 5e5})
    yield "one caliper drags", drags
    for radius in (-100.0, 100.0, -300.0, 300.0):
        where = f"bend of {abs(radius):.0f} m"
        yield where, in_bend(run, radius, 0.0)
        yield f"{where} while braking", in_bend(run, radius, 1.5)
    yield "wet road", with_plant(run, tyre=magic(14.0, 0.7))
    yield "weak front pads", weak_front(run)
    both = "weak front pads, bend of 300 m while braking"
    yield both, in_bend(weak_front(run), 300.0, 1.5)
    yield "one diagonal without pressure", with_brakes(run, fl=0.0, rr=0.0)


def exchanged(log: Log, pair: tuple[str, str]) -> Log:
    a, b = (f"omega_{w}" for w in pair)
    return replace(log, channels={**log.channels, a: log[b], b: log[a]})


def told(log: Log, expected: float) -> str:
    """Whether and which columns are named: "", "one side" or "a diagonal", or the wrong ones."""
    parts = wheel_parts(log, driving_record(log))
    for what, found in (
        ("side", crossed_side(parts)),
        ("diagonal", crossed_diagonal(parts, expected)),
    ):
        if found is not None:
            return f"{what} {found.wheels[0]} {found.wheels[1]}"
    return ""


def near_ideal(made: Line, rng: np.random.Generator) -> Line:
    """The same drives with a car that is ideally balanced at 0.3 to 0.7 g."""
    car = balanced(made.true, float(rng.uniform(0.3, 0.7)))
    runs = {name: with_plant(run, vehicle=car, pads=None) for name, run in made.runs.items()}
    return replace(made, runs=runs)


def main() -> None:
    """Print how many stops are named, and how many exchanged columns are named right."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cars", type=int, default=12)
    parser.add_argument("--seed", type=int, default=82)
    parser.add_argument("--validate", action="store_true")
    args = parser.parse_args()
    if args.validate:
        print_validated(args.cars, args.seed)
        return
    rng = np.random.default_rng(args.seed)
    asked, named, right = Counter(), Counter(), Counter()
    for number in range(args.cars):
        usual = line(rng, args.seed + number)
        for kind, made in (("", usual), ("near ideal: ", near_ideal(usual, rng))):
            for stop in ("stop_1", "stop_2"):
                count(kind, made, stop, rng, (asked, named, right))
    for key, n in asked.items():
        print(f"{key:<62} {named[key]:>4} named, {right[key]:>4} right, of {n}")


def count(kind: str, made: Line, stop: str, rng: np.random.Generator, into: tuple) -> None:
    """Ask of one stop, and add to ``into``."""
    asked, named, right = into
    run, sensors = made.runs[stop], made.sensors
    as_it_is = recorded(stop, run, sensors)
    parts = wheel_parts(as_it_is, driving_record(as_it_is))
    if parts is None:  # hardly any braking below 0.5 g
        return
    expected = parts.axles.value
    for name, other in variants(run, rng):
        found = told(recorded(stop, other, sensors), expected)
        asked[kind + name] += 1
        named[kind + name] += bool(found)
    for pair in PAIRS:
        name = f"{kind}{' with '.join(pair)}"
        found = told(exchanged(as_it_is, pair), expected)
        asked[name] += 1
        named[name] += bool(found)
        right[name] += found.endswith(" ".join(pair))


def print_validated(cars: int, seed: int) -> None:
    """Print what a validation says of stops, as they are and with exchanged columns."""
    rng, told = np.random.default_rng(seed), Counter()
    for number in range(cars):
        made = line(rng, seed + number)
        logs = [recorded(name, made.runs[name], made.sensors) for name in ("ramp", "coast")]
        try:
            table = fit(made.file, logs)
        except LogError as error:
            print(f"no table of car {number}: {error}")
            continue
        for stop in ("stop_1", "stop_2"):
            for name, log in stops_of(made, stop):
                told[name, validated(table, log)] += 1
    for (name, outcome), n in sorted(told.items()):
        print(f"{name:<32} {outcome:<24} {n:>4}")


def stops_of(made: Line, stop: str) -> Iterator[tuple[str, Log]]:
    """A stop as it is, on a wet road, in a bend, with weak front pads; exchanged columns."""
    run = made.runs[stop]
    runs = {
        "as it is": run,
        "wet road": with_plant(run, tyre=magic(14.0, 0.7)),
        "bend of 300 m while braking": in_bend(run, 300.0, 1.5),
        "weak front pads": weak_front(run),
        "weak front pads, the same bend": in_bend(weak_front(run), 300.0, 1.5),
    }
    logs = {name: recorded(stop, one, made.sensors) for name, one in runs.items()}
    yield from logs.items()
    for pair in PAIRS:
        for name in ("as it is", "wet road"):
            yield f"{name}, {' with '.join(pair)}", exchanged(logs[name], pair)


def validated(table: Table, log: Log) -> str:
    """What a validation makes of a stop."""
    try:
        (found,) = validate(table, [replace(log, truth={})])
    except LogError as error:
        return "refused by name" if "changed places" in str(error) else "refused"
    if any(warning.code == "wheels_crossed" for warning in found.warnings):
        return "named, valid" if found.estimate.valid.any() else "named, no valid sample"
    return found.verdict


if __name__ == "__main__":
    main()
