"""Cars whose runs are files with their truth: a vehicle file, ramps, coasts, stops in one folder.

    vehicle.toml   *ramp*   coast*   all else is a stop   truth/<stop>.parquet

The truth of a stop is in its own ``true_`` columns, or beside it: ``Tb_f``, ``Tb_r`` torque of one
wheel [N m], ``mu_f``, ``mu_r`` pad friction [1] over ``time`` [s]. Where runs are there with noise
and without (``stop_noisy`` beside ``stop``), those with noise are taken.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from calib.car.vehicle_file import read_vehicle
from calib.logs.log import Log
from calib.logs.read import read_log
from tests.studies.plant_r import Case, Stop


def recorded(folder: Path) -> Case:
    """The car of a folder; its first ramp in the order of the names is the one to fit."""
    files = {f.stem: f for f in sorted(folder.iterdir()) if f.suffix in (".csv", ".parquet")}
    names = [name for name in files if f"{name}_noisy" not in files]
    ramps = [name for name in names if "ramp" in name]
    coasts = [name for name in names if name.startswith("coast")]
    stops = [
        Stop(with_truth(read_log(files[name]), folder / "truth"), name, alike=True)
        for name in names
        if name not in (*ramps, *coasts)
    ]
    return Case(
        read_vehicle(folder / "vehicle.toml"),
        read_log(files[ramps[0]]),
        tuple(stops),
        read_log(files[coasts[0]]) if coasts else None,
    )


def with_truth(log: Log, folder: Path) -> Log:
    """The log with the truth that stands beside it, if its own columns have none."""
    beside = folder / f"{log.name}.parquet"
    if log.truth or not beside.exists():
        return log
    frame = pd.read_parquet(beside)
    truth = {}
    for axle in "fr":
        at_samples = {
            c: np.interp(log.time, frame["time"], frame[f"{c}_{axle}"]) for c in ("Tb", "mu")
        }
        truth |= {f"true_Tb_{axle}{side}": at_samples["Tb"] for side in "lr"}
        truth[f"true_mu_pad_{axle}"] = at_samples["mu"]
    return replace(log, truth=truth)


def folders(texts: list[str]) -> list[Path]:
    """The folders of cars among those given and right below them."""
    paths = [Path(text) for text in texts]
    below = [inner for path in paths for inner in (path, *sorted(path.iterdir()))]
    return [path for path in below if (path / "vehicle.toml").exists()]
