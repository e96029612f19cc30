"""The data of a car in C, bte_car_NAME.c: its numbers, maps and tyre, and the sum over them.

Breakpoints and precision of the maps are those of the export, as `calib.table.exported` reads them
back. What is the same in every block is computed here.
"""

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from calib.base.errors import ExchangeError
from calib.base.names import AXLES, G
from calib.base.plain import rows
from calib.car.balance import force_per_pressure, front_share, rotating_shares
from calib.car.effects.body import AIR_DENSITY
from calib.car.forces import axle_loads
from calib.ecu.car_source import Member, code, comments, header, initial
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
from calib.table.exported import Precision, as_exported
from calib.table.table import Table

CAR = "bte_car"  # first part of the name of the data, and of their file
_RESTS = 1.5  # speed of every wheel below which a car may get other data [rad/s]
_PRIME = 16_777_619  # of the sum over the data: FNV-1a, by words of 32 bits


class Number(NamedTuple):
    """A number of the car, or one for each of ``parts``: the axles, or what is read."""

    name: str
    value: float | list[float]
    comment: str  # what it is, with its unit in brackets
    parts: tuple[str, ...] = ()

    @property
    def declared(self) -> tuple[str, str]:
        """Its name and size in C, and its comment."""
        size = "BTE_AXLES" if self.parts == AXLES else "BTE_INPUTS"
        return f"{self.name}{f'[{size}]' * bool(self.parts)}", self.comment


def sources(
    table: Table, sample_time: float, how: Precision, first: str, version: int = 0, digest: str = ""
) -> dict[str, str]:
    """The estimator in C for a table, by file: bte.h, bte.c, bte_car_NAME.c.

    The first two are the same for every car of a precision. ``first`` part of the labels of the
    data; ``version`` and ``digest`` of the table. Raises StoreError as `require_plain`,
    ExchangeError for a precision that C does not have, or a time that no ECU has.
    """
    require_plain(table)
    numbers = numbers_of(table, sample_time, version)
    text, layout = header((x.declared for x in numbers), how)
    grids, real = code_grids(table, first, how), "BTE_CAL bte_real"
    tyre = as_exported(table, how).tyre  # driven and braked
    slip, force = (np.concatenate([-x[:0:-1], x]).tolist() for x in (tyre.slip, tyre.force))
    data: dict[str, tuple[str, Member]] = {
        f"{first}_digest": ("BTE_CAL char", f'"{digest}"'),
        f"{first}_numbers": ("BTE_CAL bte_numbers", {x.name: x.value for x in numbers}),
        **{axis.label: (real, axis.numbers) for axis in axes_of(grids)},
        **{grid.label: ("BTE_CAL bte_cell", _raw_of(grid)) for grid in grids},
        f"{first}_tyre_force": (real, force),
        f"{first}_tyre_slip": (real, slip),
    }
    maps = _maps(grids)
    summed = chain(_flat(numbers), *map(_summed, maps.values()), force, slip)
    car: dict[str, Member] = {
        "layout": layout,
        "size": "sizeof(bte_car) + sizeof(bte_numbers)",
        "checksum": f"0x{checksum(summed, how.floating):08X}U",
        "samples": samples_of_block(sample_time),
        "waiting": samples_in(Constants.before_bite, time_of_block(sample_time)),
        "numbers": f"&{first}_numbers",
        **{name: [_places(of), len(of[0].axes), len(of), [x.label for x in of], _steps(of)]
           for name, of in maps.items()},
        "tyre": [f"{first}_tyre_force", len(force)],
        "tyre_slip": f"{first}_tyre_slip",
    }  # fmt: skip
    written = "\n".join(_definitions(data, f"{CAR}_{first}", car, layout, how.floating))
    return {"bte.h": text, "bte.c": code(how), f"{CAR}_{first}.c": written}


def _definitions(
    data: dict[str, tuple[str, Member]], name: str, car: Member, layout: str, bits: int
) -> Iterator[str]:
    """Text of the file, of all ``data`` by label and type, and of the ``car``."""
    yield '/* $about */\n#include "bte.h"\n'
    yield f"#if BTE_LAYOUT != {layout}\n#error these data are of another bte.h: export both\n#endif"
    for label, (kind, values) in data.items():
        size = len(values) - 1 if isinstance(values, str) else len(values)
        declared = f"{kind} {label}{'' if isinstance(values, dict) else f'[{size}]'}"
        yield f"\nextern {declared};\nBTE_CAL_DATA {declared} = {initial(values, bits)};"
    body = "\n".join(f"    .{member} = {initial(x, bits)}," for member, x in car.items())
    yield f"\nextern const bte_car {name};\nconst bte_car {name} = {{\n{body}\n}};\n"


def code_grids(table: Table, first: str, how: Precision, most_axes: int = MOST_AXES) -> list[Grid]:
    """The maps that the code reads, by the labels of other formats, behind ``first``.

    Sliced where they have more axes. Raises ExchangeError as `Precision`.
    """
    read = {*(name for name, _ in PADS), *SLIP, *LEVEL}
    maps = maps_of(table, first, replace(how, code=True), most_axes)
    return [grid for _, grids in maps for grid in grids if grid.column in read]


def axes_of(grids: Iterable[Grid]) -> list[Axis]:
    """Each axis of maps once."""
    return [*{axis.label: axis for grid in grids for axis in grid.axes}.values()]


def _raw_of(grid: Grid) -> list[float] | list[int]:
    return grid.fixed.raw.tolist() if grid.fixed else grid.numbers


def numbers_of(table: Table, sample_time: float, version: int = 0) -> list[Number]:
    """Numbers of `bte_numbers`: tuned ones, those that the code reads, and those of the car.

    Raises ExchangeError for a time that no ECU has.
    """
    if not 1e-4 <= sample_time <= 0.1:
        raise ExchangeError(f"a sample time of {sample_time:g} s", expected="0.0001 to 0.1 s")
    c = constants(table, SensorNoise(**table.noise), time_of_block(sample_time))
    read = re.findall(r"\bc->(\w+)", code(Precision()))
    tuned = ((name, x) for name, x in vars(c).items() if name in read and isinstance(x, float))
    return [
        Number("version", float(version), "of the table [1]"),
        *(Number(name, x, comments(Constants.__name__)[name]) for name, x in tuned),
        *_of_car(table, sample_time),
    ]


def _of_car(table: Table, sample_time: float) -> Iterator[Number]:
    parts = {"axles": AXLES, "sensors": tuple(CHANNELS), "": ()}
    values = _values_of_car(table, sample_time)
    for row in rows("car_numbers.csv", "calib.ecu"):
        yield Number(row["name"], values[row["name"]], row["comment"], parts[row["parts"]])


def _values_of_car(table: Table, sample_time: float) -> dict[str, float | list[float]]:
    """The values of `car_numbers.csv`, by name."""
    car, resistance = table.vehicle, known_effects(table).parameters
    low, high, change = (x.tolist() for x in limits(sample_time, car))
    drag, rolling = resistance[DRAG[0]], resistance[ROLLING[0]]
    at_20, grows = rolling[ROLLING[1]], rolling.get("rolling_growth", 0.0)
    lever, axles = car.cg_height / car.wheelbase, (car.front, car.rear)
    lift = (1.0 - drag.get("load_share", 1.0)) * lever
    turning, radii = rotating_shares(car), [axle.rolling_radius for axle in axles]
    on_ramp = front_share(car, table.calibration.pad_log_ratio.value)
    return {
        "low": low,
        "high": high,
        "change": change,
        "sample_time": sample_time,
        "rests": _RESTS,
        "lateral_part": 1.0 - math.exp(-sample_time / LATERAL_TIME),
        "recent": Constants.recover + 0.5 * sample_time,  # else a rounding could decide it
        "slowing": Constants.slows * sample_time,
        "load": [float(x[0]) / car.weight for x in axle_loads(car, np.zeros(1))],
        "height": [lever, -lever],
        "track_width": car.track_width,
        "leaning": 4.0 * car.cg_height / (G * car.track_width),
        "drag": 0.5 * AIR_DENSITY * drag[DRAG[1]] / car.weight,
        "drag_lift": [-lift, lift],
        "rolling": at_20 * (1.0 - grows),
        "rolling_growth": at_20 * grows / 20.0**2,
        "rolling_radius": radii,
        "drive": [1.0 / (radius * car.weight) for radius in radii],
        "turns": [*turning],
        "spinning": [share * radius / G for share, radius in zip(turning, radii, strict=True)],
        "rolls": 1.0 + sum(turning),
        "torque_gain": [axle.torque_gain for axle in axles],
        "pad_friction": [axle.pad_friction for axle in axles],
        "force": sum(force_per_pressure(car)) / car.weight,
        "share": front_share(car, 0.0),
        "ramp_share": [on_ramp, 1.0 - on_ramp],
    }


def _maps(grids: Iterable[Grid]) -> dict[str, list[Grid]]:
    """Columns of each map of `bte_car`."""
    by_column, ratio = {(g.column, len(g.axes)): g for g in grids}, [x for x, _ in PADS]
    maps = {"pads": (ratio, 3), "slip": (SLIP, 2), "level": (LEVEL, 1), "prior": (ratio, 1)}
    return {name: [by_column[x, axes] for x in columns] for name, (columns, axes) in maps.items()}


def _places(columns: list[Grid]) -> list[Member]:
    return [[axis.label, len(axis.values)] for axis in columns[0].axes]


def _steps(columns: list[Grid]) -> list[float]:
    return [x.fixed.step if x.fixed else 1.0 for x in columns]


def _flat(numbers: Iterable[Number]) -> Iterator[float]:
    for x in numbers:
        yield from x.value if isinstance(x.value, list) else [x.value]


def _summed(columns: list[Grid]) -> Iterator[float]:
    """Numbers of a map in the order of `checksum` in bte.c."""
    for axis in columns[0].axes:
        yield from axis.numbers
    for grid, step in zip(columns, _steps(columns), strict=True):
        yield step
        yield from _raw_of(grid)


def checksum(values: Iterable[float], bits: int) -> int:
    """`checksum` of bte.c, of numbers in a floating point of ``bits``, in any byte order."""
    array, total = np.array([*values], f"<f{bits // 8}"), 0
    for word in array.view(f"<u{bits // 8}").tolist():
        for half in (word & 0xFFFF_FFFF, word >> 32):
            total = (total ^ half) * _PRIME & 0xFFFF_FFFF
    return total
