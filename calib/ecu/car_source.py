"""The numbers of a car as C: what the estimator of bte.c takes from a table.

The maps are on as many breakpoints and in the precision that the export asks for: what is written
is what `calib.table.exported` reads back.
"""

import math
from collections.abc import Iterable
from dataclasses import fields

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ExchangeError
from calib.car.braking import BITE, MOVING
from calib.car.effects.body import AIR_DENSITY
from calib.car.forces import axle_loads
from calib.ecu.labels import code_maps, version_label
from calib.ecu.online import Timing
from calib.ecu.width import Width
from calib.estimation.constants import LEVEL, PADS, SLIP, Constants, constants
from calib.estimation.known import known_effects
from calib.estimation.reasons import HARDEST, LATERAL, LOCK, RECOVER, STEERING
from calib.exports.dataset import Grid
from calib.model.resistance import DRAG, ROLLING
from calib.run.driving_record import NOMINAL_RADIUS, STEADY
from calib.run.lateral import LATERAL_TIME
from calib.run.noise import WALK, SensorNoise
from calib.table.exported import as_exported
from calib.table.table import Table

PREFIX = "bte"
"""First part of every label, of files and functions, too."""
_RATIO = tuple(names[0] for names in PADS)
_FASTEST, _SLOWEST = 1e-4, 0.1  # times from call to call [s]
_FROM_TABLE = ("noise_v", "late", "late_sigma", "radii", "ramp_ratio", "block")
"""Numbers of `Constants` that are no tuning, or of a speed that no ECU has."""


def require_time(sample_time: float) -> None:
    """Raise ExchangeError for a time from call to call [s] that no ECU has."""
    if not _FASTEST <= sample_time <= _SLOWEST:
        expected = f"{_FASTEST:g} to {_SLOWEST:g} s"
        raise ExchangeError(f"a sample time of {sample_time:g} s", expected=expected)


def tuning(c: Constants) -> dict[str, float]:
    """The tuned numbers by their names in `bte_tuning`."""
    scalars = (field.name for field in fields(Constants) if field.type is float)
    of_step = {name: getattr(c, name) for name in scalars if name not in _FROM_TABLE}
    return of_step | {
        "bite": BITE, "moving": MOVING, "steady": STEADY, "radius_walk": WALK,
        "steering": STEERING, "lateral": LATERAL, "lock": LOCK, "recover": RECOVER,
        "slows": HARDEST / NOMINAL_RADIUS, "turning": MOVING / NOMINAL_RADIUS,
    }  # fmt: skip


def car_numbers(table: Table, c: Constants, sample_time: float) -> dict[str, float | list[float]]:
    """The scalars of `bte_car` by name, those of axles as (front, rear)."""
    car, known = table.vehicle, known_effects(table).parameters
    front, rear = axle_loads(car, np.zeros(1))
    drag, rolling = known[DRAG[0]], known[ROLLING[0]]
    lever = car.cg_height / (car.weight * car.wheelbase)
    axles = (car.front, car.rear)
    return {
        "sample_time": sample_time,
        "lateral_part": 1.0 - math.exp(-sample_time / LATERAL_TIME),
        "weight": car.weight,
        "load_f": float(front[0]) / car.weight,
        "load_r": float(rear[0]) / car.weight,
        "height": car.cg_height / car.wheelbase,
        "track_width": car.track_width,
        "cg_height": car.cg_height,
        "drag": 0.5 * AIR_DENSITY * drag[DRAG[1]],
        "drag_lift": (1.0 - drag.get("load_share", 1.0)) * lever,
        "rolling": rolling[ROLLING[1]],
        "rolling_growth": rolling.get("rolling_growth", 0.0),
        "radius": [axle.rolling_radius for axle in axles],
        "inertia": [axle.wheel_inertia for axle in axles],
        "torque_gain": [axle.torque_gain for axle in axles],
        "pad_friction": [axle.pad_friction for axle in axles],
        "ramp_ratio": c.ramp_ratio,
        "log_ratio": table.calibration.pad_log_ratio.value,
    }


def car_source(table: Table, sample_time: float, width: Width, told: str, version: int = 0) -> str:
    """bte_car.c; ``told`` is what the file says of its table, ``version`` its number.

    Raises ExchangeError for a precision that C does not have, or a time that no ECU has.
    """
    require_time(sample_time)
    axes, grids = code_maps(table, PREFIX, width)
    table = as_exported(table, width.how)
    timing = Timing.of(sample_time)
    c = constants(table, SensorNoise(**table.noise), timing.block)
    parts = [_array(axis.label, axis.values, width) for axis in axes]
    parts += [_cells(grid, width) for grid in grids]
    tyre = {"tyre_force": table.tyre.force, "tyre_slip": table.tyre.slip}
    for name, x in tyre.items():
        told_of = ", ".join(map(width.number, x.tolist()))
        parts.append(f"static BTE_CAL bte_real {name}[] = {{{told_of}}};")
    z, shift, slip, level_z = (axis.label for axis in axes)
    of = {(grid.column, len(grid.axes)): grid for grid in grids}
    ratio = [of[name, 3] for name in _RATIO]
    level, before = ([of[name, 1] for name in names] for names in (LEVEL, _RATIO))
    mean, sigma = (of[name, 2] for name in SLIP)
    members = {
        "version": f"&{version_label(PREFIX)}",
        "tuning": _nested(tuning(c), width),
        "samples": f"{timing.samples}U",
        "waiting": f"{timing.waiting}U",
        **{name: _told(x, width) for name, x in car_numbers(table, c, sample_time).items()},
        "tyre": _axis("tyre_force"),
        "tyre_slip": "tyre_slip",
        "z": _axis(z),
        "shift": _axis(shift),
        "slip": _axis(slip),
        **_map("ratio", ratio, width),
        "slip_mean": mean.label,
        "slip_sigma": sigma.label,
        "slip_mean_step": width.number(_step(mean)),
        "slip_sigma_step": width.number(_step(sigma)),
        "level_z": _axis(level_z),
        **_map("level", level, width),
        **_map("before", before, width),
    }
    numbered = f"BTE_CAL bte_real {version_label(PREFIX)}"
    body = "\n".join(f"    .{name} = {text}," for name, text in members.items())
    return "\n\n".join(
        [
            f"/* {told} */",
            '#include "bte.h"',
            "#define COUNT(x) ((uint16_t)(sizeof(x) / sizeof((x)[0])))",
            f"extern {numbered};\nBTE_CAL_DATA {numbered} = {width.number(version)};",
            *parts,
            f"const bte_car bte_this_car = {{\n{body}\n}};\n",
        ]
    )


def _array(label: str, values: Array, width: Width) -> str:
    """An array that a calibration tool knows."""
    return _public("bte_real", label, map(width.number, values.tolist()))


def _cells(grid: Grid, width: Width) -> str:
    if grid.fixed is None:
        return _public("bte_cell", grid.label, map(width.number, grid.numbers))
    return _public("bte_cell", grid.label, map(str, grid.fixed.raw.tolist()))


def _public(kind: str, label: str, numbers: Iterable[str]) -> str:
    told = list(numbers)
    declared = f"BTE_CAL {kind} {label}[{len(told)}]"
    return f"extern {declared};\nBTE_CAL_DATA {declared} = {{{', '.join(told)}}};"


def _told(x: float | list[float], width: Width) -> str:
    if isinstance(x, list):
        return "{" + ", ".join(map(width.number, x)) + "}"
    return width.number(x)


def _nested(values: dict[str, float], width: Width) -> str:
    return "{" + ", ".join(f".{name} = {width.number(x)}" for name, x in values.items()) + "}"


def _axis(label: str) -> str:
    return f"{{{label}, COUNT({label})}}"


def _step(grid: Grid) -> float:
    return grid.fixed.step if grid.fixed else 1.0


def _map(member: str, grids: list[Grid], width: Width) -> dict[str, str]:
    """The median and both bounds of a map, and the steps of their cells."""
    return {
        member: "{" + ", ".join(grid.label for grid in grids) + "}",
        f"{member}_step": _told([_step(grid) for grid in grids], width),
    }
