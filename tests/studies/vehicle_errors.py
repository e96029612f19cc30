"""What an entry of the vehicle file that is 10 % too large does to pads and torque.

    python tests/studies/vehicle_errors.py --seed 31 --runs 4 [--no-v]

One car of the independent plant, with drag, rolling resistance and radii that differ by 0.08 %: a
ramp and a coast with dry pads, a stop with wet ones, sensor noise by the seed. Each entry is made
10 % larger, in the file of the fit, and so of the estimate too. Printed is the change against the
right file, in percent: pads of the table, pads and brake torque of the stop (median of the valid
samples), front and rear, the median of the runs; the share of valid samples of the stop whose
interval holds the true pads; and the warnings of fit and stop that are new.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.car.vehicle import Vehicle
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from calib.logs.log import Log
from tests.studies.against_truth import against_truth, mean, truths_of
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, WET, noisy, ramp, stop, without

FILE = replace(CAR, mass_tolerance=Vehicle.mass_tolerance)
LARGER = 1.1

CHASSIS = ("mass", "cg_to_front_axle", "cg_to_rear_axle", "cg_height", "track_width")
OF_AXLE = ("rolling_radius", "wheel_inertia", "piston_area", "effective_radius", "pad_friction")


def wrong_files() -> Iterator[tuple[str, Vehicle]]:
    """Each entry 10 % too large, and a caliper whose second pad face was forgotten."""
    for key in CHASSIS:
        yield key, replace(FILE, **{key: LARGER * getattr(FILE, key)})
    for side in ("front", "rear"):
        axle = getattr(FILE, side)
        for key in OF_AXLE:
            wrong = replace(axle, **{key: LARGER * getattr(axle, key)})
            yield f"{side} {key}", replace(FILE, **{side: wrong})
    for key in ("rolling_radius", "piston_area", "pad_friction"):
        both = {
            side: replace(getattr(FILE, side), **{key: LARGER * getattr(getattr(FILE, side), key)})
            for side in ("front", "rear")
        }
        yield f"both {key}", replace(FILE, **both)
    one_face = {s: replace(getattr(FILE, s), friction_faces=1) for s in ("front", "rear")}
    yield "both friction_faces = 1, not 2", replace(FILE, **one_face)


def driven(seed: int, with_v: bool) -> tuple[list[Log], Log]:
    """Ramp and coast for the fit, and the stop."""
    coast = as_log(drive(REAL, lambda t: 0.0, 33.0, duration=20.0), "coast")
    made = [noisy(log, seed + i) for i, log in enumerate((ramp(REAL), coast, stop(WET)))]
    ramped, coasted, stopped = made if with_v else [without(log, "v") for log in made]
    return [ramped, coasted], stopped


def answer(vehicle: Vehicle, logs: list[Log], held_out: Log) -> tuple[np.ndarray, set[str]]:
    """Table's pads, stop's pads and torque, truth in the interval, front and rear; warnings."""
    table = fit(vehicle, logs)
    judged = validate_one(table, held_out, None, DEFAULTS, baselines=False)
    found = judged.estimate
    f, r, at = found.front, found.rear, found.valid
    pads = table.calibration
    values = [pads.pad_friction_f.value, pads.pad_friction_r.value]
    values += [float(np.median(x[at])) for x in (f.pad_friction, r.pad_friction)]
    values += [float(np.median(x[at])) for x in (f.torque, r.torque)]
    values += [mean(axle.held) for axle in against_truth(found, truths_of(held_out))]
    codes = {w.code for w in (*table.warnings, *judged.warnings)}
    return np.array(values), codes


def main() -> None:
    """Print one row for each entry."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=31)
    parser.add_argument("--runs", type=int, default=4)
    parser.add_argument("--no-v", action="store_true")
    given = parser.parse_args()
    runs = [driven(given.seed + 10 * i, not given.no_v) for i in range(given.runs)]
    right = [answer(FILE, *run) for run in runs]
    print("entry | table's pads | pads of the stop | torque of the stop | truth held | warnings")
    for name, vehicle in wrong_files():
        try:
            wrong = [answer(vehicle, *run) for run in runs]
        except BrakeCalError as error:
            print(f"{name} | refused: {error}")
            continue
        pairs = list(zip(wrong, right, strict=True))
        change = np.median([100 * (w / r - 1)[:6] for (w, _), (r, _) in pairs], axis=0)
        held = np.median([100 * w[6:] for w, _ in wrong], axis=0)
        new = sorted({code for (_, w), (_, r) in pairs for code in w - r})
        cells = [f"{a:+.1f} / {b:+.1f}" for a, b in change.reshape(3, 2)]
        cells.append("{:.0f} / {:.0f}".format(*held))
        print(" | ".join([name, *cells, ", ".join(new)]))


if __name__ == "__main__":
    main()
