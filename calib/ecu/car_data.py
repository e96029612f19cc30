"""The data of a car in C: bte_car_NAME.c with its numbers, its maps, its tyre and their checksum.

    table --numbers_of--> bte_numbers
    table --code_grids--> maps --> bte_car

Breakpoints and precision of the maps are those of the export, as `calib.table.exported` reads them
back. A number that is the same in every block is computed here, not in the ECU.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import Any

import numpy as np

from calib.base.errors import ExchangeError
from calib.base.names import AXLES, G
from calib.base.plain import rows
from calib.car.balance import force_per_pressure, front_share, rotating_shares
from calib.car.effects.body import AIR_DENSITY
from calib.car.forces import axle_loads
from calib.ecu.structures import Number, code, comments, header, initial, source
from calib.estimation.constants import LEVEL, PADS, SLIP, Constants, constants
from calib.estimation.known import known_effects, require_plain
from calib.estimation.online import CHANNELS, limits
from calib.exports.build import maps_of
from calib.exports.dataset import MOST_AXES, Axis, Grid
from calib.run.blocks import samples_of_block, time_of_block
from calib.run.filters import samples_in
from calib.run.lateral import LATERAL_TIME
from calib.run.noise import SensorNoise
from calib.run.resistance import DRAG, ROLLING
from calib.store.version import Stored
from calib.table.exported import Precision, as_exported
from calib.table.table import Table

CAR = "bte_car"  # first part of the name of the data, and of their file
_RESTS = 1.5  # speed of every wheel below which a car may get other data [rad/s]
_FNV_PRIME = 16_777_619  # of the checksum, FNV-1a by words of 32 bits instead of bytes
_PARTS = {"axles": AXLES, "sensors": tuple(CHANNELS), "": ()}  # by a column of car_numbers.csv


def sources(
    stored: Stored, sample_time: float, how: Precision, first: str, about: str = ""
) -> dict[str, str]:
    """Return the estimator in C for a version of a table, by file: bte.h, bte.c, bte_car_NAME.c.

    Labels of the data begin with ``first``, their file with the comment ``about``. Raises
    StoreError as `require_plain`, ExchangeError as `Precision` and `numbers_of`.
    """
    table = stored.table
    require_plain(table)
    numbers, grids = numbers_of(stored, sample_time), code_grids(table, first, how)
    text, layout = header(numbers, how)
    maps, tyre = _maps(grids), as_exported(table, how).tyre
    # C has the tyre curve for thrust, too: mirrored at its first point, which is 0
    force, slip = ([*(-x[:0:-1]).tolist(), *x.tolist()] for x in (tyre.force, tyre.slip))
    of_maps = chain.from_iterable(values for _, values in maps.values())
    checked = [*chain.from_iterable(x.values for x in numbers), *of_maps, *force, *slip]
    car: dict[str, Any] = {
        "layout": layout,
        "size": "sizeof(bte_car) + sizeof(bte_numbers)",
        "checksum": f"0x{checksum(checked, how.floating):08X}U",
        "samples": samples_of_block(sample_time),
        "waiting": samples_in(Constants.before_bite, time_of_block(sample_time)),
        "numbers": f"&{first}_numbers",
        **{name: members for name, (members, _) in maps.items()},
        "tyre": [f"{first}_tyre_force", len(force)],
        "tyre_slip": f"{first}_tyre_slip",
    }
    arrays = [
        *(("bte_real", axis.label, axis.numbers) for axis in axes_of(grids)),
        *(("bte_cell", grid.label, _cells(grid)) for grid in grids),
        ("bte_real", f"{first}_tyre_force", force),
        ("bte_real", f"{first}_tyre_slip", slip),
    ]
    data = source(
        "bte_car.c.j2", about=about, first=first, layout=layout, digest=stored.digest,
        numbers={x.name: x.value for x in numbers}, arrays=arrays, car=car, name=f"{CAR}_{first}",
        initial=partial(initial, bits=how.floating),
    )  # fmt: skip
    return {"bte.h": text, "bte.c": code(how), f"{CAR}_{first}.c": data}


def code_grids(table: Table, first: str, how: Precision, most_axes: int = MOST_AXES) -> list[Grid]:
    """Return the maps that the code reads, with labels as in other formats.

    A map of more than ``most_axes`` is sliced. Raises ExchangeError as `Precision`.
    """
    columns = {*(name for name, _ in PADS), *SLIP, *LEVEL}
    maps = maps_of(table, first, replace(how, code=True), most_axes)
    return [grid for _, grids in maps for grid in grids if grid.column in columns]


def axes_of(grids: Iterable[Grid]) -> list[Axis]:
    """Return the axes of maps, each once."""
    return [*{axis.label: axis for grid in grids for axis in grid.axes}.values()]


def _maps(grids: Iterable[Grid]) -> dict[str, tuple[list[Any], list[float]]]:
    """Return the members of each `bte_map` in order, and its numbers in that of `checksum` in C."""
    by_column = {(grid.column, len(grid.axes)): grid for grid in grids}
    ratio, maps = [name for name, _ in PADS], dict[str, tuple[list[Any], list[float]]]()
    for name, names, count in (
        ("pads", ratio, 3), ("slip", SLIP, 2), ("level", LEVEL, 1), ("prior", ratio, 1),
    ):  # fmt: skip
        columns = [by_column[column, count] for column in names]
        axes, steps = columns[0].axes, [x.fixed.step if x.fixed else 1.0 for x in columns]
        points = [[axis.label, len(axis.values)] for axis in axes]
        cells = [[step, *_cells(x)] for step, x in zip(steps, columns, strict=True)]
        members = [points, count, len(columns), [x.label for x in columns], steps]
        maps[name] = members, [*chain(*(axis.numbers for axis in axes), *cells)]
    return maps


def _cells(grid: Grid) -> list[Any]:
    return grid.fixed.raw.tolist() if grid.fixed else grid.numbers


def checksum(values: list[float], bits: int) -> int:
    """Return the checksum of floats of ``bits``, as `checksum` of bte.c computes it."""
    total = 0
    for number in np.array(values, f"<f{bits // 8}").view(f"<u{bits // 8}").tolist():
        for word in (number & 0xFFFF_FFFF, number >> 32):
            total = (total ^ word) * _FNV_PRIME & 0xFFFF_FFFF
    return total


def numbers_of(stored: Stored, sample_time: float) -> list[Number]:
    """Return the numbers of `bte_numbers`. Raises ExchangeError for an unusual sample time."""
    if not 1e-4 <= sample_time <= 0.1:
        raise ExchangeError(f"a sample time of {sample_time:g} s", expected="0.0001 to 0.1 s")
    table = stored.table
    c = constants(table, SensorNoise(**table.noise), time_of_block(sample_time))
    read = re.findall(r"\bc->(\w+)", code(Precision()))  # names that the C code uses
    tuned = {name: x for name, x in vars(c).items() if name in read and isinstance(x, float)}
    about, of_car = comments(Constants.__name__), _values_of_car(table, sample_time)
    numbers = [Number("version", float(stored.version), "of the table [1]")]
    numbers += [Number(name, x, about[name]) for name, x in tuned.items()]
    for row in rows("car_numbers.csv", "calib.ecu"):
        name = row["name"]
        numbers.append(Number(name, of_car[name], row["comment"], _PARTS[row["parts"]]))
    return numbers


def _values_of_car(table: Table, sample_time: float) -> dict[str, float | list[float]]:
    """Return the values of the numbers of car_numbers.csv, SI."""
    car, resistance = table.vehicle, known_effects(table).parameters
    low, high, change = (x.tolist() for x in limits(sample_time, car))
    drag, rolling = resistance[DRAG[0]], resistance[ROLLING[0]]
    # rolling resistance at 20 m/s, and the part of it that grows with the square of the speed
    at_20, grows = rolling[ROLLING[1]], rolling.get("rolling_growth", 0.0)
    lever, axles = car.cg_height / car.wheelbase, (car.front, car.rear)
    lift = (1.0 - drag.get("load_share", 1.0)) * lever
    turning, radii = rotating_shares(car), [axle.rolling_radius for axle in axles]
    on_ramp = front_share(car, table.calibration.pad_log_ratio.value)
    return {
        "low": low, "high": high, "change": change,
        "sample_time": sample_time, "rests": _RESTS,
        "lateral_part": 1.0 - math.exp(-sample_time / LATERAL_TIME),
        "recent": Constants.recover + 0.5 * sample_time,  # between samples: no rounding decides
        "slowing": Constants.slows * sample_time,
        "load": [float(x[0]) / car.weight for x in axle_loads(car, np.zeros(1))],
        "height": [lever, -lever], "track_width": car.track_width,
        "leaning": 4.0 * car.cg_height / (G * car.track_width),
        "drag": 0.5 * AIR_DENSITY * drag[DRAG[1]] / car.weight, "drag_lift": [-lift, lift],
        "rolling": at_20 * (1.0 - grows), "rolling_growth": at_20 * grows / 20.0**2,
        "rolling_radius": radii,
        "drive": [1.0 / (radius * car.weight) for radius in radii],
        "turns": [*turning], "rolls": 1.0 + sum(turning),
        "spinning": [share * radius / G for share, radius in zip(turning, radii, strict=True)],
        "torque_gain": [axle.torque_gain for axle in axles],
        "pad_friction": [axle.pad_friction for axle in axles],
        "force": sum(force_per_pressure(car)) / car.weight,
        "share": front_share(car, 0.0), "ramp_share": [on_ramp, 1.0 - on_ramp],
    }  # fmt: skip
