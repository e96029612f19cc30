"""Logs for the fleet's study and benchmark: stops of 2,000 samples, made by `simulate`."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from calib.car.model import default_model
from calib.car.vehicle import Vehicle
from calib.fitting.fit import fit
from calib.logs.write import write_csv
from calib.model.manoeuvre import ramp
from calib.model.sensor_noise import add_noise
from calib.model.simulate import simulate
from calib.table.table import Table

SAMPLES, RATE = 2000, 200.0


def table_of(car: Vehicle) -> Table:
    """A table of the car, fitted on a simulated ramp."""
    drive = ramp(33.0)
    log = simulate(default_model(car), drive.time, drive.pressure, drive.v0, name="ramp")
    return fit(car, [add_noise(replace(log, truth={}), 0)])


def write_logs(car: Vehicle, folder: Path, distinct: int) -> list[Path]:
    """``distinct`` stops with pads, pressure and noise of their own, without truth, as CSV."""
    folder.mkdir(parents=True)
    time = np.arange(SAMPLES) / RATE
    paths = []
    for i in range(distinct):
        pads = 1.0 - 0.02 * (i % 10)
        model = default_model(car)
        model = replace(
            model,
            pad_friction_f=pads * model.pad_friction_f,
            pad_friction_r=pads * model.pad_friction_r,
        )
        top = (12.0 + 0.5 * (i % 7)) * 1e5
        pressure = np.clip((time - 1.5) / 0.25, 0.0, 1.0) * top
        log = simulate(model, time, pressure, 33.0, name=f"stop_{i}")
        assert log.time.size == SAMPLES
        paths.append(folder / f"stop_{i:03d}.csv")
        write_csv(add_noise(replace(log, truth={}), i + 1), paths[-1])
    return paths


def linked(paths: list[Path], folder: Path, count: int) -> Path:
    """``count`` names for the logs in turn: hard links, which cost no disk. Same name, same log."""
    folder.mkdir(parents=True)
    for i in range(count):
        os.link(paths[i % len(paths)], folder / f"car_{i:06d}.csv")
    return folder
