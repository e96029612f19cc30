"""What the length of a ramp costs: pads and stops by tables of ramps of 2 to 10 s.

    python tests/studies/ramp_length.py [--seeds 12]

Every ramp rises to the same pressure, 0.5 g, after 1.5 s of rolling, and the table is fitted from
it alone. Prints for each car and length, as medians over the seeds, in percent: the error and the
half width of the 95 % interval of the pads of the ramp, and of a stop with other pads (0.31, 0.27)
that is validated with the table; how often the interval of the stop holds the truth; how many
ramps were refused.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import LogError
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, stop, with_pads, without

LENGTHS = (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
TOP = 35e5
"""Pressure at the end of each ramp [Pa]: 0.5 g."""
LEAD_IN = 1.5
PADS = (0.31, 0.27)
CARS = {
    "as it is": ((), REAL),
    "without v": (("v",), REAL),
    "brakes 0.1 s late": ((), replace(REAL, hydraulic_lag=0.1)),
}


def ramp_of(plant, length):
    run = drive(
        plant,
        lambda t: TOP * min(max((t - LEAD_IN) / length, 0.0), 1.0),
        33.0,
        duration=LEAD_IN + length,
        stop_speed=3.0,
    )
    return as_log(run, "ramp")


def tried(log, held, seed, gone):
    """Errors and half widths of ramp and stop [%], and whether the stop's intervals hold."""
    table = fit(CAR, [without(noisy(log, seed), *gone)])
    (result,) = validate(table, [without(noisy(held, 1000 + seed), *gone)])
    row = []
    for side, nominal, true in (("f", CAR.front, PADS[0]), ("r", CAR.rear, PADS[1])):
        pads = getattr(table.calibration, f"pad_friction_{side}")
        value, width = result.figures[f"pad_friction_{side}"], result.figures[f"interval_{side}"]
        error = value / true - 1.0
        row += [
            pads.value / nominal.pad_friction - 1.0,
            1.96 * pads.sigma / pads.value,
            error,
            width,
            float(abs(error) <= width),
        ]
    return 100.0 * np.abs(row)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=12)
    seeds = parser.parse_args().seeds
    heads = ("ramp: error", "+-", "stop: error", "+-", "holds")
    print(f"{'car':<18} {'s':>4}  refused  " + "  ".join(f"{h:>13}" for h in heads))
    for name, (gone, plant) in CARS.items():
        held = stop(with_pads(plant, *PADS))
        for length in LENGTHS:
            log, rows, refused = ramp_of(plant, length), [], 0
            for seed in range(seeds):
                try:
                    rows.append(tried(log, held, seed, gone))
                except LogError:
                    refused += 1
            text = ""
            if rows:
                found = np.asarray(rows)
                middle = np.median(found, axis=0)
                middle[[4, 9]] = found.mean(axis=0)[[4, 9]]
                pairs = zip(middle[:5], middle[5:], strict=True)
                cells = [f"{f:5.1f} / {r:5.1f}" for f, r in pairs]
                text = "  ".join(f"{cell:>13}" for cell in cells)
            print(f"{name:<18} {length:4.0f}  {refused:>3}/{seeds:<3}  {text}", flush=True)


if __name__ == "__main__":
    main()
