"""Ramps that go near to the peak of the tyres: pads and tyres that are taken for each other.

    python tests/studies/hard_ramps.py [--cars 20] [--seed 1]

Cars of `ensemble` whose pads differ from the file's, and whose tyres differ between the axles, by
5 % (one sigma of each axle). Each has a coast log, a ramp to 0.5 or to 0.7 g and a stop at 0.35 g
with the pads of the ramp; the mass is known to 0.5 %. Printed: how often `fit` warns of `pad_ratio`
though the ratio is within 9 % of the file's, how often its 95 % interval misses the ratio, its rms
error; coverage and rms error of the stop's pads, front / rear.
"""

import argparse
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.base.intervals import Z95
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from calib.plausibility.limits import PLAUSIBLE
from tests.studies.against_truth import against_truth, mean, truths_of
from tests.studies.coverage import without_v
from tests.studies.fast_pedal import BITE, drawn, rising, run
from tests.support.plant import per_pascal


def main() -> None:
    """Print one row per height of the ramp, with and without v."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cars", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    print(f"{asked.cars} cars, seed {asked.seed}")
    for top in (0.5, 0.7):
        made = []
        for number in range(asked.cars):
            plant, levels = drawn(asked.seed, number)
            rng, car = np.random.default_rng([asked.seed, number, 3]), plant.vehicle
            front, rear, tyres = np.exp(rng.normal(0.0, (0.05, 0.05, 0.07))).tolist()
            pads = (front * car.front.pad_friction, rear * car.rear.pad_friction)
            plant = replace(plant, pads=lambda t, p=pads: p, rear_stiffness=tyres)
            slope = 6.0 if top < 0.6 else 9.0
            length = BITE + top / per_pascal(car) / slope / 1e5
            how = {"duration": round(20.0 * length) / 20.0, "stop_speed": 5.0}
            ramp = run(plant, levels, rising(slope), 33.0, 1, **how)
            coast = run(plant, levels, rising(0.0), 32.0, 2, duration=12.0)
            pressure = rising(60.0, 0.35 / per_pascal(car))
            stop = run(plant, levels, pressure, 28.0, 3, duration=10.0, stop_speed=1.5)
            made.append((car, math.log(front / rear), ramp, coast, stop))
        for told, less in (("with v", lambda log: log), ("without v", without_v)):
            off, false, near, held, wrong = [], 0, 0, [], []
            for car, true, ramp, coast, stop in made:
                try:
                    table = fit(car, [less(ramp), less(coast)])
                    result = validate_one(table, less(stop), None, DEFAULTS, baselines=False)
                except BrakeCalError:
                    continue
                ratio, e = table.calibration.pad_log_ratio, result.estimate
                off.append((ratio.value - true, ratio.sigma))
                near += abs(true) < PLAUSIBLE.pad_ratio
                warned = any(w.code == "pad_ratio" for w in table.warnings)
                false += warned and abs(true) < PLAUSIBLE.pad_ratio
                for axle in against_truth(e, truths_of(stop)):
                    held.append(mean(axle.held))
                    wrong.append(mean(axle.error))
            x, s = np.array(off).T
            share = np.nanmean(np.reshape(held, (-1, 2)), axis=0)
            rms = 100.0 * np.sqrt(np.nanmean(np.reshape(wrong, (-1, 2)) ** 2, axis=0))
            print(f"ramp to {top:g} g, {told:10} {x.size:3} cars: pad_ratio warned {false} of "
                  f"{near} falsely, ratio outside {np.sum(np.abs(x) > Z95 * s)}, rms "
                  f"{100.0 * np.sqrt(np.mean(x**2)):.1f} %; stop {share[0]:.2f} / {share[1]:.2f}, "
                  f"rms {rms[0]:.1f} / {rms[1]:.1f} %")  # fmt: skip


if __name__ == "__main__":
    main()
