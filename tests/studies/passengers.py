"""Passengers in the stops only: how often is the load named?

    python tests/studies/passengers.py [--cars 10] [--seed 1]

Cars of `ensemble`, each with a ramp, a coast log and stops at 0.2 and 0.4 g: as on the ramp; with
two or three people and bags (160 to 300 kg), whose weight is half to three quarters of the
wheelbase behind the front axle; and with front pads at 0.85. With and without v, mass known to 3 %
and to 0.5 %. Printed: how many stops have the load among the first two causes of a warning, how
many no warning, and the lowest coverage of those.
"""

import argparse
import sys
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.car.mass import WEIGHED
from calib.car.vehicle import Vehicle
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from tests.studies.against_truth import against_truth, mean, truths_of
from tests.studies.coverage import without_v
from tests.studies.fast_pedal import drawn, ramp_and_coast, rising, run
from tests.support.plant import per_pascal


def loaded(car: Vehicle, mass: float, behind: float) -> Vehicle:
    """The car with ``mass`` [kg] more, ``behind`` the front axle by a share of the wheelbase."""
    total = car.mass + mass
    front = (car.mass * car.cg_to_front_axle + mass * behind * car.wheelbase) / total
    rear = car.wheelbase - front
    return replace(car, mass=total, cg_to_front_axle=front, cg_to_rear_axle=rear)


def main() -> None:
    """Print one row per kind of stop."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cars", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    found: dict[tuple[str, str], list[tuple[bool, bool, float]]] = defaultdict(list)
    for number in range(asked.cars):
        plant, levels = drawn(asked.seed, number)
        rng, car = np.random.default_rng([asked.seed, number, 2]), plant.vehicle
        mass, behind = rng.uniform((160.0, 0.5), (300.0, 0.75)).tolist()
        mu_f, mu_r = car.front.pad_friction, car.rear.pad_friction
        kinds = {
            "as on the ramp": plant,
            "passengers": replace(plant, vehicle=loaded(car, mass, behind)),
            "front pads 0.85": replace(plant, pads=lambda t, f=mu_f, r=mu_r: (0.85 * f, r)),
        }
        of_fit = ramp_and_coast(plant, levels, 0.55)
        stops = [
            (kind, run(of, levels, rising(60.0, z / per_pascal(car)), 27.0, 10 + k, duration=10.0,
                       stop_speed=1.5))
            for kind, of in kinds.items() for k, z in enumerate((0.2, 0.4))
        ]  # fmt: skip
        for told, less in (("with v", lambda log: log), ("without v", without_v)):
            for tolerance in (0.03, WEIGHED):
                try:
                    table = fit(
                        replace(car, mass_tolerance=tolerance), [less(log) for log in of_fit]
                    )
                except BrakeCalError:
                    continue
                for kind, log in stops:
                    result = validate_one(table, less(log), None, DEFAULTS, baselines=False)
                    axles = against_truth(result.estimate, truths_of(log))
                    held = [mean(axle.held) for axle in axles]
                    named = any("load" in " ".join(w.causes[:2]) for w in result.warnings)
                    found[kind, told].append((named, bool(result.warnings), min(held)))
    print(f"{asked.cars} cars, seed {asked.seed}")
    for (kind, told), rows in found.items():
        silent = [share for _, warned, share in rows if not warned]
        valid = [share for share in silent if np.isfinite(share)]
        lowest = f"lowest coverage {min(valid):.2f}" if valid else ""
        print(f"{kind:16} {told:10} {len(rows):3} stops, load named {sum(r[0] for r in rows):3}, "
              f"no warning {len(silent):3} {lowest}")  # fmt: skip


if __name__ == "__main__":
    main()
