"""The numbers of a car as C: what the estimator of bte.c takes from a table.

The maps are on as many breakpoints and in the precision that the export asks for: what is written
is what `calib.table.exported` reads back.
"""

import math
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ExchangeError
from calib.car.braking import BITE, MOVING
from calib.car.effects.body import AIR_DENSITY
from calib.car.forces import axle_loads
from calib.ecu.online import Timing
from calib.estimation.constants import LEVEL, PADS, SLIP, Constants, constants
from calib.estimation.known import known_effects
from calib.estimation.reasons import LATERAL, LOCK, RECOVER, STEERING
from calib.model.resistance import DRAG, ROLLING
from calib.run.driving_record import STEADY
from calib.run.lateral import LATERAL_TIME
from calib.run.noise import WALK, SensorNoise
from calib.table.exported import Precision, Written, as_exported
from calib.table.table import Table

_RATIO = tuple(names[0] for names in PADS)
_FASTEST, _SLOWEST = 1e-4, 0.1  # times from call to call [s]
_BEFORE = tuple(f"before_{name}" for name in _RATIO)
_FROM_TABLE = ("noise_v", "late", "late_sigma", "radii", "ramp_ratio", "block")
"""Numbers of `Constants` that are no tuning, or of a speed that no ECU has."""


@dataclass(frozen=True)
class Width:
    """How the numbers are computed with: ``bits`` of the floating point, 32 or 64.

    ``how`` the maps are written: breakpoints, and the bits of their cells where these are integers.
    """

    bits: int
    how: Precision

    @classmethod
    def of(cls, how: Precision) -> Self:
        """Single precision where the table is written so or in integers, else double."""
        return cls(32 if how.single or how.bits else 64, how)

    @property
    def cell(self) -> str:
        """Type of the cells of the maps in C."""
        return f"int{self.how.bits}_t" if self.how.bits else "bte_real"

    def rounded(self, x: Array) -> Array:
        """Numbers as the floating point holds them."""
        return x.astype(np.float32).astype(np.float64) if self.bits == 32 else x

    def number(self, x: float) -> str:
        """A constant in C that reads back to the last bit of its precision."""
        told = repr(float(np.float32(x)) if self.bits == 32 else float(x))
        if self.bits == 32:
            told = np.format_float_scientific(np.float32(x), unique=True, trim="0")
        return f"{told}F" if self.bits == 32 else told


def require_time(sample_time: float) -> None:
    """Raise ExchangeError for a time from call to call [s] that no ECU has."""
    if not _FASTEST <= sample_time <= _SLOWEST:
        expected = f"{_FASTEST:g} to {_SLOWEST:g} s"
        raise ExchangeError(f"a sample time of {sample_time:g} s", expected=expected)


def tuning(table: Table, timing: Timing) -> dict[str, float]:
    """The tuned numbers by their names in `bte_tuning`."""
    c = constants(table, SensorNoise(**table.noise), timing.block)
    scalars = (field.name for field in fields(Constants) if field.type is float)
    of_step = {name: getattr(c, name) for name in scalars if name not in _FROM_TABLE}
    return of_step | {
        "bite": BITE, "moving": MOVING, "steady": STEADY, "radius_walk": WALK,
        "steering": STEERING, "lateral": LATERAL, "lock": LOCK, "recover": RECOVER,
    }  # fmt: skip


def car_numbers(table: Table, sample_time: float) -> dict[str, float | list[float]]:
    """The scalars of `bte_car` by name, those of axles as (front, rear)."""
    car, known = table.vehicle, known_effects(table).parameters
    timing, (front, rear) = Timing.of(sample_time), axle_loads(car, np.zeros(1))
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
        "ramp_ratio": constants(table, SensorNoise(**table.noise), timing.block).ramp_ratio,
        "log_ratio": table.calibration.pad_log_ratio.value,
    }


def car_source(table: Table, sample_time: float, width: Width, told: str) -> str:
    """bte_car.c; ``told`` is what the file says of its table.

    Raises ExchangeError for a precision that C does not have, or a time that no ECU has.
    """
    require_time(sample_time)
    table = as_exported(table, width.how)
    ratio, level = table.map, table.level_map
    assert ratio is not None
    assert level is not None
    timing, numbers = Timing.of(sample_time), car_numbers(table, sample_time)
    axes = {**ratio.axes, "level_z": level.z, "tyre": table.tyre.force}
    parts = [_array(f"axis_{name}", x, width) for name, x in axes.items()]
    parts.append(_array("tyre_slip", table.tyre.slip, width))
    columns = {name: getattr(ratio, name) for name in (*_RATIO, *SLIP)}
    columns |= {name: getattr(level, name) for name in LEVEL}
    columns |= {f"before_{name}": getattr(level, name) for name in _RATIO}
    cells = {name: width.how.numbers(column) for name, column in columns.items()}
    parts += [_cells(f"cells_{name}", x, width) for name, x in cells.items()]
    members = {
        "tuning": _nested(tuning(table, timing), width),
        "samples": f"{timing.samples}U",
        "waiting": f"{timing.waiting}U",
        **{name: _told(x, width) for name, x in numbers.items()},
        "tyre": _axis("tyre"),
        "tyre_slip": "tyre_slip",
        **{name: _axis(name) for name in ratio.axes},
        **_map("ratio", _RATIO, cells, width),
        "slip_mean": f"cells_{SLIP[0]}",
        "slip_sigma": f"cells_{SLIP[1]}",
        "slip_mean_step": width.number(_step(cells[SLIP[0]])),
        "slip_sigma_step": width.number(_step(cells[SLIP[1]])),
        "level_z": _axis("level_z"),
        **_map("level", LEVEL, cells, width),
        **_map("before", _BEFORE, cells, width),
    }
    body = "\n".join(f"    .{name} = {text}," for name, text in members.items())
    return "\n\n".join(
        [
            f"/* {told} */",
            '#include "bte.h"',
            "#define COUNT(x) ((uint16_t)(sizeof(x) / sizeof((x)[0])))",
            *parts,
            f"const bte_car bte_this_car = {{\n{body}\n}};\n",
        ]
    )


def _array(name: str, values: Array, width: Width) -> str:
    told = ", ".join(map(width.number, values.tolist()))
    return f"static BTE_CAL bte_real {name}[] = {{{told}}};"


def _cells(name: str, x: Written, width: Width) -> str:
    raw = x.fixed.raw.tolist() if x.fixed else x.values.tolist()
    told = ", ".join(str(one) if x.fixed else width.number(one) for one in raw)
    return f"static BTE_CAL bte_cell {name}[] = {{{told}}};"


def _told(x: float | list[float], width: Width) -> str:
    if isinstance(x, list):
        return "{" + ", ".join(map(width.number, x)) + "}"
    return width.number(x)


def _nested(values: dict[str, float], width: Width) -> str:
    return "{" + ", ".join(f".{name} = {width.number(x)}" for name, x in values.items()) + "}"


def _axis(name: str) -> str:
    return f"{{axis_{name}, COUNT(axis_{name})}}"


def _step(x: Written) -> float:
    return x.fixed.step if x.fixed else 1.0


def _map(
    label: str, names: tuple[str, ...], cells: dict[str, Written], width: Width
) -> dict[str, str]:
    """The median and both bounds of a map, and the steps of their cells."""
    return {
        label: "{" + ", ".join(f"cells_{name}" for name in names) + "}",
        f"{label}_step": _told([_step(cells[name]) for name in names], width),
    }
