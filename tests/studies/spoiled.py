"""Spoil logs at random, and list what ends in a traceback or in a number that is not finite.

python tests/studies/spoiled.py [--logs 2000] [--seed 1]
"""

import argparse
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.fitting.fit import fit
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop
from tests.support.spoiled import findings, spoiled


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    runs = {True: noisy(ramp(REAL), 1), False: noisy(stop(REAL), 2)}
    table = fit(CAR, [runs[True]])
    seen = Counter[str]()
    for number in range(chosen.logs):
        rng = np.random.default_rng([chosen.seed, number])
        is_ramp = bool(rng.random() < 0.5)
        done, text = spoiled(runs[is_ramp], rng)
        for flaw in findings(text, table, is_ramp):
            if not seen[flaw]:
                print(f"{number:5d} {'ramp' if is_ramp else 'stop'}: {done}\n      {flaw}")
            seen[flaw] += 1
    print(f"{chosen.logs} logs, {sum(seen.values())} findings, {len(seen)} kinds")


if __name__ == "__main__":
    main()
