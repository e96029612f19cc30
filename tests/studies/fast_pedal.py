"""A fast pedal on tyres that build up their force over some way: coverage and error of the pads.

    python tests/studies/fast_pedal.py --cars 3 --seed 5 [--no-v]

Cars of `ensemble`, each with a slow ramp, a coast log and three stops: pads as on the ramp, and the
front ones 15 % better or worse against the rear ones, on the road of the ramp and on basalt. A
vehicle file that knows the mass to 0.5 %. One row per relaxation and pedal: share of valid samples
whose 95 % interval holds the truth, over all and in the worst stop; rms of the stops' mean errors
and mean half width of the interval, front and rear; how many of the stops pass.
"""

import argparse
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.car.mass import WEIGHED
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.model.sensor_noise import LEVELS, NoiseLevel, add_noise
from calib.table.table import Table
from tests.studies.against_truth import against_truth, mean, truths_of
from tests.studies.coverage import without_v
from tests.studies.ensemble import car, tyre
from tests.support.plant import Plant, Pressure, as_log, drive, per_pascal

RELAXATIONS = (0.0, 0.15, 0.3, 0.5)
"""Way [m] over which the tyres build up their force."""
PEDALS = (20.0, 45.0, 90.0)
"""Rise of the pressure in a stop [bar/s]."""
ROADS = {"ramp's": ((1.0, 1.0), 0.45, 1.0), "basalt": ((0.95, 0.55), 0.28, 0.7)}
"""Stiffness and peak over those of the ramp's road, deceleration [g], level of the pads."""
RATIOS = (0.0, 0.15, -0.15)
BITE = 1.5
"""Time of rolling before the brake [s]."""

Levels = dict[str, NoiseLevel]


def drawn(seed: int, number: int) -> tuple[Plant, Levels]:
    """One car and the noise of its sensors."""
    rng = np.random.default_rng([seed, number])
    plant = Plant(
        vehicle=replace(car(rng), mass_tolerance=WEIGHED),
        tyre=tyre(rng),
        drag_area=0.65,
        rolling_resistance=0.011,
        radius_scale=(1.0, 1.0 + float(rng.normal(0.0, 0.001))),
        pitch_frequency=float(rng.choice([0.0, rng.uniform(1.1, 1.6)], p=[0.3, 0.7])),
    )
    loud = float(rng.uniform(0.3, 1.2))
    return plant, {k: replace(v, sd=v.sd * loud) for k, v in LEVELS.items()}


def rising(slope: float, most: float = math.inf) -> Pressure:
    """Pressure [Pa] that rises by ``slope`` [bar/s] after `BITE` up to ``most`` [Pa]."""
    return lambda t: min(1e5 * slope * max(t - BITE, 0.0), most)


def run(
    plant: Plant, levels: Levels, pressure: Pressure, v0: float, seed: int, **how: float
) -> Log:
    """One run as the sensors give it."""
    return add_noise(as_log(drive(plant, pressure, v0, **how), f"run {seed}"), seed, levels)


def ramp_and_coast(plant: Plant, levels: Levels, top: float) -> list[Log]:
    """A slow ramp up to a deceleration of ``top`` [g], and a coast log."""
    end = BITE + top / per_pascal(plant.vehicle) / 6e5
    how = {"duration": round(20.0 * end) / 20.0, "stop_speed": 8.0}
    ramp = run(plant, levels, rising(6.0), 32.0, 1, **how)
    return [ramp, run(plant, levels, rising(0.0), 32.0, 2, duration=12.0)]


def table_of(plant: Plant, levels: Levels, keep_v: bool) -> Table:
    """The table of a slow ramp and a coast log."""
    logs = ramp_and_coast(plant, levels, 0.58)
    return fit(plant.vehicle, logs if keep_v else [without_v(log) for log in logs])


def stop(plant: Plant, levels: Levels, pedal: float, road: str, ratio: float, seed: int) -> Log:
    """One stop from 25 m/s."""
    surface, aim, level = ROADS[road]
    front, rear = plant.vehicle.front.pad_friction, plant.vehicle.rear.pad_friction
    half = math.exp(0.5 * ratio)
    braked = replace(
        plant, surface=lambda x: surface, pads=lambda t: (front * level * half, rear * level / half)
    )
    pressure = rising(pedal, aim / per_pascal(plant.vehicle) / level)
    return run(braked, levels, pressure, 25.0, seed, duration=11.0, stop_speed=1.5)


def scored(table: Table, log: Log) -> list[float]:
    """Valid samples, coverage, mean error and half width [%] front and rear; whether it passed."""
    result = validate_one(table, log, None, DEFAULTS, baselines=False)
    e, out = result.estimate, []
    for axle in against_truth(e, truths_of(log)):
        out += [mean(axle.held), mean(100.0 * axle.error), mean(100.0 * axle.half_width)]
    return [float(e.valid.sum()), *out, float(result.passed)]


def main() -> None:
    """Print one row per relaxation and pedal."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cars", type=int, default=3)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--no-v", action="store_true")
    asked = parser.parse_args()
    print(f"{asked.cars} cars, seed {asked.seed}, {'without' if asked.no_v else 'with'} v")
    print("relaxation  pedal   coverage f/r  lowest f/r    error %       half width %  passed")
    for way in RELAXATIONS:
        found: dict[float, list[list[float]]] = {pedal: [] for pedal in PEDALS}
        for number in range(asked.cars):
            plant, levels = drawn(asked.seed, number)
            plant = replace(plant, relaxation=way)
            table = table_of(plant, levels, not asked.no_v)
            for pedal in PEDALS:
                for k, (road, ratio) in enumerate((a, b) for a in ROADS for b in RATIOS):
                    log = stop(plant, levels, pedal, road, ratio, 10 + k)
                    found[pedal].append(scored(table, without_v(log) if asked.no_v else log))
        for pedal, rows in found.items():
            print(f"{way:7.2f} m {pedal:4.0f}/s   {told_of(np.array(rows))}", flush=True)


def told_of(rows: np.ndarray) -> str:
    """Pooled coverage, the lowest of a stop, rms of the mean errors, mean half widths, passed."""
    rows, total = rows[rows[:, 0] > 0], len(rows)
    held = np.average(rows[:, [1, 4]], axis=0, weights=rows[:, 0])
    pairs = (held, rows[:, [1, 4]].min(axis=0))
    shares = "   ".join(f"{f:.2f} / {r:.2f}" for f, r in pairs)
    error = np.sqrt(np.mean(rows[:, [2, 5]] ** 2, axis=0))
    width = np.mean(rows[:, [3, 6]], axis=0)
    sizes = "   ".join(f"{f:4.1f} / {r:4.1f}" for f, r in (error, width))
    return f"{shares}   {sizes}   {int(rows[:, 7].sum())} of {total}"


if __name__ == "__main__":
    main()
