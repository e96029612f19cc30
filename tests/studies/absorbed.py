"""What a diagnosis says to effects that pads take up, and how wrong the pads are then.

    python tests/studies/absorbed.py --seed 88100 --count 3
    python tests/studies/absorbed.py --seed 88300 --count 3 --top 0.7

Those that have no name of their own, a radius that falls under load, another mass, and nothing: of
each ``--count`` cases of the plant in tests/support/hidden, severities in turn. With ``--top``
ramps and hard stops reach that deceleration over g. Printed: the answer, the pads over the true
ones, and how often their 95 % interval holds those. Its figures: `results/absorbed.md`.
"""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.diagnosis.diagnose import Diagnosis, diagnose
from tests.support.hidden import manoeuvres
from tests.support.hidden.cases import HiddenCase, draw
from tests.support.hidden.severities import ABSORBED


def main() -> None:
    """Draw, diagnose, print one line a case."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=88100)
    parser.add_argument("--count", type=int, default=3)
    parser.add_argument("--top", type=float)
    asked = parser.parse_args()
    if asked.top:
        harder(asked.top)
    for name in (*ABSORBED, "rolling_radius_load", "mass_error", ""):
        print(name or "nothing")
        held = np.zeros(2, int)
        for i in range(asked.count):
            names, kind = ((name,), "single") if name else ((), "none")
            case = draw(kind, asked.seed + i, names=names, severity=i % 3)
            found = diagnose(case.vehicle, list(case.calibration), list(case.holdout))
            held += holds(case, found)
            print(asked.seed + i, line(case, found), flush=True)
        print(f"held {held[0]} / {held[1]} of {asked.count}")


def harder(top: float) -> None:
    """Let ramps and hard stops of the drawn runs reach this deceleration over g."""
    manoeuvres.LEVEL["step_high"] = (top - 0.03, top)
    manoeuvres.LEVEL["hot_stop"] = (top - 0.05, top)
    manoeuvres.LEVEL["stop_a"] = (top - 0.1, top - 0.05)

    def ramp(name: str, rng: np.random.Generator) -> tuple[Callable, float]:
        slope = rng.uniform(*((0.131, 0.176) if name == "ramp_fast" else (0.074, 0.081)))
        duration = round(float(manoeuvres.BITE + top / slope + 0.5), 2)
        return lambda t: np.clip(slope * (t - manoeuvres.BITE), 0.0, top), duration

    manoeuvres.SHAPES["ramp"] = manoeuvres.SHAPES["ramp_fast"] = ramp


def true_pads(case: HiddenCase) -> tuple[float, float]:
    """The pad friction of the plant, front and rear [1]."""
    scale, car = case.answer["base"], case.vehicle
    return (
        car.front.pad_friction * scale["mu_scale_f"],
        car.rear.pad_friction * scale["mu_scale_r"],
    )


def holds(case: HiddenCase, found: Diagnosis) -> list[bool]:
    """Whether the intervals of the pads hold the true ones, front and rear."""
    told = (found.base[f"pad_friction_{a}"].ci95 for a in "fr")
    return [low <= true <= high for (low, high), true in zip(told, true_pads(case), strict=True)]


def line(case: HiddenCase, found: Diagnosis) -> str:
    """Settings, verdict, names with parameters, pads over the true ones."""
    named = {
        e.name: {k: f"{v.value:.3g} in {v.ci95[0]:.3g} to {v.ci95[1]:.3g}" for k, v in
                 e.parameters.items()} for e in found.effects
    }  # fmt: skip
    pads = []
    for a, true in zip("fr", true_pads(case), strict=True):
        told = found.base[f"pad_friction_{a}"]
        half = 0.5 * (told.ci95[1] - told.ci95[0]) / told.value
        pads.append(f"{told.value / true:.3f} +- {half:.3f}")
    return f"{case.answer['settings']}: {found.verdict} {named}, pads over true {', '.join(pads)}"


if __name__ == "__main__":
    main()
