"""The numbers of a car as C: what the estimator of bte.c takes from a table.

The maps are on as many breakpoints and in the precision that the export asks for: what is written
is what `calib.table.exported` reads back. What is the same in every block is computed here.
"""

import math
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from calib.base.errors import ExchangeError
from calib.base.names import G
from calib.car.balance import turning_shares
from calib.car.bias import force_per_pressure, front_share
from calib.car.braking import BITE, MOVING
from calib.car.effects.body import AIR_DENSITY
from calib.car.forces import axle_loads
from calib.ecu.channels import limits
from calib.ecu.labels import code_maps, version_label
from calib.ecu.online import HELD_PRESSURE, HELD_TIME, RESTS, Timing
from calib.ecu.width import Width
from calib.estimation.constants import LEVEL, PADS, SLIP, Constants, constants
from calib.estimation.known import known_effects
from calib.estimation.readout import SLOWEST
from calib.estimation.reasons import HARDEST, LATERAL, LOCK, RECOVER, STEERING
from calib.exports.dataset import Grid
from calib.model.resistance import DRAG, ROLLING
from calib.run.driving_record import NOMINAL_RADIUS, STEADY
from calib.run.lateral import LATERAL_TIME
from calib.run.noise import WALK, SensorNoise
from calib.table.exported import as_exported
from calib.table.table import Table

SOURCE = Path(__file__).parent / "source"
CONFIG = "/* The precision of the estimator of brake-cal. */"
"""How bte_config.h begins, in every folder of the code."""

PREFIX = "bte"
"""First part of every label, of files and functions, too."""
_RATIO = tuple(names[0] for names in PADS)
_FASTEST, _SLOWEST = 1e-4, 0.1  # times from call to call [s]
_FROM_TABLE = ("noise_v", "late", "late_sigma", "radii", "ramp_ratio", "block")
"""Numbers of `Constants` that are no tuning, or of a speed that no ECU has."""

Member: TypeAlias = Any
"""A member of a structure in C: a number, a list or dict of members; a text stands as it is."""


def require_time(sample_time: float) -> None:
    """Raise ExchangeError for a time from call to call [s] that no ECU has."""
    if not _FASTEST <= sample_time <= _SLOWEST:
        expected = f"{_FASTEST:g} to {_SLOWEST:g} s"
        raise ExchangeError(f"a sample time of {sample_time:g} s", expected=expected)


def _tuning(c: Constants) -> dict[str, Member]:
    scalars = (field.name for field in fields(Constants) if field.type is float)
    of_step = {name: getattr(c, name) for name in scalars if name not in _FROM_TABLE}
    return of_step | {
        "bite": BITE, "moving": MOVING, "steady": STEADY, "radius_walk": WALK,
        "slowest": SLOWEST, "rests": RESTS, "held_time": HELD_TIME, "held_pressure": HELD_PRESSURE,
        "steering": STEERING, "lateral": LATERAL, "lock": LOCK, "recover": RECOVER,
        "slows": HARDEST / NOMINAL_RADIUS, "turning": MOVING / NOMINAL_RADIUS,
    }  # fmt: skip


def _numbers(table: Table, sample_time: float) -> dict[str, Member]:
    """Members of `bte_car` that are no maps; those of axles as [front, rear]."""
    timing = Timing.of(sample_time)
    c = constants(table, SensorNoise(**table.noise), timing.block)
    car, known = table.vehicle, known_effects(table).parameters
    drag, rolling = known[DRAG[0]], known[ROLLING[0]]
    low, high, jump = (x.tolist() for x in limits(sample_time))
    on_ramp, axles = front_share(car, table.calibration.pad_log_ratio.value), (car.front, car.rear)
    lever = car.cg_height / (car.weight * car.wheelbase)
    return {
        "version": f"&{version_label(PREFIX)}",
        "tuning": _tuning(c),
        "low": low,
        "high": high,
        "jump": jump,
        "samples": timing.samples,
        "waiting": timing.waiting,
        "sample_time": sample_time,
        "block": timing.block,
        "lateral_part": 1.0 - math.exp(-sample_time / LATERAL_TIME),
        "weight": car.weight,
        "load": [float(load[0]) / car.weight for load in axle_loads(car, np.zeros(1))],
        "height": car.cg_height / car.wheelbase,
        "track_width": car.track_width,
        "cg_height": car.cg_height,
        "drag": 0.5 * AIR_DENSITY * drag[DRAG[1]],
        "drag_lift": (1.0 - drag.get("load_share", 1.0)) * lever,
        "rolling": rolling[ROLLING[1]],
        "rolling_growth": rolling.get("rolling_growth", 0.0),
        "radius": [axle.rolling_radius for axle in axles],
        "turning_mass": [car.weight / G * share for share in turning_shares(car)],
        "torque_gain": [axle.torque_gain for axle in axles],
        "pad_friction": [axle.pad_friction for axle in axles],
        "force": sum(force_per_pressure(car)),
        "share": front_share(car, 0.0),
        "ramp_share": [on_ramp, 1.0 - on_ramp],
        "ramp_ratio": c.ramp_ratio,
    }


def sources(
    table: Table, sample_time: float, width: Width, told: str, version: int = 0
) -> dict[str, str]:
    """The estimator in C for a table, by file: bte.h, bte.c, bte_config.h, bte_car.c.

    ``told`` is what the last file says of its table, ``version`` its number. Raises ExchangeError
    for a precision that C does not have, or a time that no ECU has.
    """
    precision = f"#define BTE_FLOAT {width.bits}\n#define BTE_CELL {width.cell}\n"
    return {name: (SOURCE / name).read_text(encoding="utf-8") for name in ("bte.h", "bte.c")} | {
        "bte_config.h": f"{CONFIG}\n{precision}",
        "bte_car.c": _car(table, sample_time, width, told, version),
    }


def _car(table: Table, sample_time: float, width: Width, told: str, version: int) -> str:
    require_time(sample_time)
    axes, grids = code_maps(table, PREFIX, width)
    table = as_exported(table, width.how)
    arrays = [_public("bte_real", a.label, map(width.number, a.values.tolist())) for a in axes]
    for g in grids:
        cells = map(width.number, g.numbers) if g.fixed is None else map(str, g.fixed.raw.tolist())
        arrays.append(_public("bte_cell", g.label, cells))
    for name, x in (("tyre_force", table.tyre.force), ("tyre_slip", table.tyre.slip)):
        values = _initial(x.tolist(), width)
        arrays.append(f"static BTE_CAL bte_real {name}[] = {values};")
    *over, level_z = (_axis(axis.label) for axis in axes)
    of = {(grid.column, len(grid.axes)): _map(grid) for grid in grids}
    members = _numbers(table, sample_time) | {
        "tyre": _axis("tyre_force"),
        "tyre_slip": "tyre_slip",
        "axes": over,
        "ratio": [of[name, 3] for name in _RATIO],
        "slip_mean": of[SLIP[0], 2],
        "slip_sigma": of[SLIP[1], 2],
        "level_z": level_z,
        "level": [of[name, 1] for name in LEVEL],
        "before": [of[name, 1] for name in _RATIO],
    }
    numbered = f"BTE_CAL bte_real {version_label(PREFIX)}"
    body = "\n".join(f"    .{name} = {_initial(x, width)}," for name, x in members.items())
    return "\n\n".join(
        [
            f"/* {told} */",
            '#include "bte.h"',
            "#define COUNT(x) ((uint16_t)(sizeof(x) / sizeof((x)[0])))",
            f"extern {numbered};\nBTE_CAL_DATA {numbered} = {width.number(version)};",
            *arrays,
            f"const bte_car bte_this_car = {{\n{body}\n}};\n",
        ]
    )


def _public(kind: str, label: str, numbers: Iterable[str]) -> str:
    """An array that a calibration tool knows."""
    told = list(numbers)
    declared = f"BTE_CAL {kind} {label}[{len(told)}]"
    return f"extern {declared};\nBTE_CAL_DATA {declared} = {{{', '.join(told)}}};"


def _axis(label: str) -> list[Member]:
    return [label, f"COUNT({label})"]


def _map(grid: Grid) -> list[Member]:
    return [grid.label, grid.fixed.step if grid.fixed else 1.0]


def _initial(x: Member, width: Width) -> str:
    """The initial value of a member in C."""
    if isinstance(x, dict):
        return f"{{{', '.join(f'.{name} = {_initial(y, width)}' for name, y in x.items())}}}"
    if isinstance(x, list):
        return f"{{{', '.join(_initial(y, width) for y in x)}}}"
    if isinstance(x, int):
        return f"{x}U"
    return x if isinstance(x, str) else width.number(x)
