"""What ramps with one axle only buy, and whether the intervals hold.

    python tests/studies/one_axle.py --cars 30 --seed 7000

Cars of the independent plant, drawn as `calib.fit` believes them: pads, tyres and radii are as
declared or not, with the odds of `FitSettings` and the spreads of the priors (`--unlike`: none is
as declared; `--no-v`: without reference speed). Pads repeat within 1.5 % per axle from ramp to
ramp, tyres within 1 %. Those of the normal ramp are the truth.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import LogError
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.model.parameters import PRIORS
from calib.model.settings import SETTINGS
from calib.table.table import Table
from tests.support.one_axle import one_axle
from tests.support.plant import Plant, brush, magic
from tests.support.reference_car import CAR, REAL, noisy, ramp, with_pads, without

Rng = np.random.Generator

SETS = {"normal": "n", "and front": "nf", "and rear": "nr", "and both": "nfr"}
JUDGED = ("pads' ratio", "tyres' ratio", "front pads", "rear pads")


def departs(rng: Rng, odds: float, wide: float, narrow: float) -> float:
    """What is wide with these odds, else narrow."""
    return float(rng.normal(0.0, wide if rng.random() < odds else narrow))


def drawn(rng: Rng, unlike: bool) -> tuple[Plant, float, float]:
    """A car, and the logarithms of its pads' and its tyres' ratio."""
    s = SETTINGS
    odds = (1.0, 1.0, 1.0) if unlike else (s.pads_differ, s.tyres_differ, s.radii_fall)
    pads = departs(rng, odds[0], PRIORS.log_pad_ratio.sigma, s.pad_tolerance)
    tyres = departs(rng, odds[1], PRIORS.log_tyre_ratio.sigma, s.tyre_tolerance)
    radii = departs(rng, odds[2], PRIORS.radius_load.sigma, s.radius_tolerance)
    kind = {
        "stiffness": rng.uniform(16.0, 38.0),
        "peak": rng.uniform(0.85, 1.1),
        "load_exponent": rng.uniform(0.0, 0.08),
    }
    tyre = brush(**kind)
    if rng.random() < 0.7:
        tyre = magic(shape=rng.uniform(1.4, 1.7), curvature=rng.uniform(-1.0, 0.3), **kind)
    plant = replace(
        REAL,
        tyre=tyre,
        rear_stiffness=float(np.exp(tyres)),
        radius_load=radii,
        drag_area=rng.uniform(0.5, 0.8),
        rolling_resistance=rng.uniform(0.008, 0.014),
        radius_scale=(1.0, 1.0 + rng.normal(0.0, 0.001)),
    )
    return plant, pads, tyres


def driven(rng: Rng, plant: Plant, pads: float) -> tuple[dict[str, Log], tuple[float, float]]:
    """The three ramps, and the pads of the normal one."""
    level = 0.38 * np.exp(rng.normal(0.0, 0.08))
    logs, used = {}, {}
    for kind in "nfr":
        own = np.exp(rng.normal(0.0, 0.015, 2))
        used[kind] = (level * np.exp(0.5 * pads) * own[0], level * np.exp(-0.5 * pads) * own[1])
        warm = float(np.exp(rng.normal(0.0, 0.01)))
        car = with_pads(replace(plant, surface=lambda x, warm=warm: (warm, 1.0)), *used[kind])
        made = ramp(car) if kind == "n" else one_axle(car, kind)
        logs[kind] = noisy(made, int(rng.integers(2**31)))
    return logs, used["n"]


def errors(table: Table, pads: tuple[float, float], tyres: float) -> Iterator[tuple[float, float]]:
    """Error and sigma [1] of what is judged, in its order."""
    ratio, apart = np.log(pads[0] / pads[1]), table.posterior
    yield apart.value("log_pad_ratio") - ratio, apart.sigma("log_pad_ratio")
    yield apart.value("log_tyre_ratio") - tyres, apart.sigma("log_tyre_ratio")
    found = table.calibration
    for value, true in zip((found.pad_friction_f, found.pad_friction_r), pads, strict=True):
        yield value.value / true - 1.0, value.sigma / true


def main() -> None:
    """Print coverage, sigma and error of each set of ramps."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cars", type=int, default=30)
    parser.add_argument("--seed", type=int, default=7000)
    parser.add_argument("--unlike", action="store_true")
    parser.add_argument("--no-v", action="store_true")
    given = parser.parse_args()
    rows: dict[str, list[list[tuple[float, float]]]] = {name: [] for name in SETS}
    for seed in range(given.seed, given.seed + given.cars):
        rng = np.random.default_rng(seed)
        plant, pads, tyres = drawn(rng, given.unlike)
        logs, true = driven(rng, plant, pads)
        if given.no_v:
            logs = {kind: without(log, "v") for kind, log in logs.items()}
        try:
            tables = {name: fit(CAR, [logs[k] for k in kinds]) for name, kinds in SETS.items()}
        except LogError as error:
            print(f"car {seed} is refused: {error}")
            continue
        for name, table in tables.items():
            rows[name].append(list(errors(table, true, tyres)))
    print(f"{'ramps':<11}{'':<14}{'in 95 %':>8}{'sigma %':>9}{'rms error %':>13}")
    for name, of in rows.items():
        error, sigma = np.moveaxis(np.array(of), 2, 0)
        for i, judged in enumerate(JUDGED):
            held = np.mean(np.abs(error[:, i]) < 1.96 * sigma[:, i])
            rms = np.sqrt(np.mean(error[:, i] ** 2))
            middle = np.median(sigma[:, i])
            print(f"{name:<11}{judged:<14}{held:8.2f}{100 * middle:9.1f}{100 * rms:13.1f}")


if __name__ == "__main__":
    main()
