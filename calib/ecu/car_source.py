"""The estimator in C for a car: bte.h with what Python names, and the car's numbers in bte_car.c.

The maps are on as many breakpoints and in the precision that the export asks for: what is written
is what `calib.table.exported` reads back. What is the same in every block is computed here.
"""

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import asdict, fields, is_dataclass, replace
from importlib import resources
from itertools import starmap
from pathlib import Path
from string import Template
from textwrap import fill, indent
from typing import Any, TypeAlias

import numpy as np

from calib.base.errors import ExchangeError, StoreError
from calib.base.names import G
from calib.car.balance import force_per_pressure, front_share, turning_shares
from calib.car.effects.body import AIR_DENSITY
from calib.car.forces import axle_loads
from calib.ecu.translation import structure, translated
from calib.estimation.known import known_effects
from calib.estimation.online import ANSWERS, CHANNELS, answered, limits
from calib.estimation.reasons import Reason
from calib.estimation.state import LEVEL, PADS, SLIP, Constants, constants
from calib.estimation.step import started
from calib.exports.build import maps_of
from calib.exports.dataset import MOST_AXES, Axis, Grid
from calib.run.blocks import BLOCK, samples_of_block
from calib.run.lateral import LATERAL_TIME
from calib.run.noise import SensorNoise
from calib.run.resistance import DRAG, RESISTANCE, ROLLING
from calib.table.exported import Precision, as_exported
from calib.table.table import Table

SOURCE = Path(__file__).parent / "source"
PREFIX = "bte"  # first part of every label, of files and functions, too
_MATH = {  # how a floating point calls sqrt, and has exp and ln
    32: {"function": "name##f", "terms": 8, "largest": 87},
    64: {"function": "name", "terms": 14, "largest": 700},
}
_RESTS = 1.5  # speed of every wheel below which a car may get other numbers [rad/s]

_Member: TypeAlias = Any
"""A member of a structure: a number (whole: a count), text as in C, a list, or a structure."""


def sources(
    table: Table, sample_time: float, how: Precision, told: str, version: int = 0
) -> dict[str, str]:
    """The estimator in C for a table, by file: bte.h, bte.c, bte_car.c.

    ``told`` is what the last file says of its table, ``version`` its number. Raises StoreError as
    `require_plain`, ExchangeError for a precision that C does not have, or a time that no ECU has.
    """
    if not 1e-4 <= sample_time <= 0.1:
        raise ExchangeError(f"a sample time of {sample_time:g} s", expected="0.0001 to 0.1 s")
    require_plain(table)
    grids, samples = code_grids(table, PREFIX, how), samples_of_block(sample_time)
    table = as_exported(table, how)
    c = constants(table, SensorNoise(**table.noise), round(samples * sample_time, 9))
    equations = (resources.files("calib.estimation") / "equations.py").read_text(encoding="utf-8")
    code = _source("bte.c").substitute(_MATH[how.floating], equations=translated(equations))
    begun, numbers = started(c), _numbers(c, table, sample_time, code)
    state = {x.name: getattr(begun, x.name) for x in fields(begun) if x.name != "waiting"}
    state |= {"kept": begun.kept[:6:2], "since_lock": 2.0 * c.recover}
    first = answered(table, BLOCK / 2.0, np.zeros((2, len(CHANNELS))))[0]
    start = {"reason": int(Reason.NOT_BRAKED), "told": first[1:13].reshape(4, 3).tolist()}
    car = {
        **numbers,
        **_maps(grids),
        "start": state | start,
        "samples": samples,  # of a block
        "waiting": max(1, round(c.before_bite / c.block)),  # blocks on which no zero rests
        "version": f"&{PREFIX}_version",
        "tyre": [f"{PREFIX}_tyre_force", 2 * table.tyre.force.size - 1],
        "tyre_slip": f"{PREFIX}_tyre_slip",
    }
    data: dict[str, _Member] = {f"{PREFIX}_version": float(version)}
    for name, x in (("force", table.tyre.force), ("slip", table.tyre.slip)):  # driven and braked
        data[f"{PREFIX}_tyre_{name}"] = np.concatenate([-x[:0:-1], x]).tolist()
    written = "\n\n".join((f"/* {told} */", '#include "bte.h"', *_data(grids, data, car, how)))
    return {"bte.h": _header(state, numbers, how), "bte.c": code, "bte_car.c": written}


def _header(state: dict[str, _Member], numbers: dict[str, _Member], how: Precision) -> str:
    return _source("bte.h").substitute(
        real="float" if how.floating == 32 else "double",
        cell=cell(how),
        reasons=_enumeration((f"{x.name} = {int(x)}", x.words) for x in Reason),
        inputs=_enumeration((x.name, f"{x.meaning} [{x.unit}]") for x in CHANNELS.values()),
        answers=_enumeration((x.name, f"{x.meaning} [{x.unit}]") for x in ANSWERS.values()),
        filters="\n".join(_structures(state.values())),
        state="\n".join(f"    {_kind(x)} {_declared(name, x)};" for name, x in state.items()),
        numbers=indent(fill(", ".join(starmap(_declared, numbers.items())), 88), 8 * " ").lstrip(),
    )


def _data(
    grids: list[Grid], data: dict[str, _Member], car: dict[str, _Member], how: Precision
) -> Iterator[str]:
    """Definitions: of maps, of other ``data`` that has a label, and of `bte_this_car`."""
    held = (*axes_of(grids), *grids)
    maps = {x.label: x.fixed.raw.tolist() if x.fixed else x.numbers for x in held}
    cells = {grid.label for grid in grids}
    for name, values in (data | maps).items():
        kind = "bte_cell" if name in cells else "bte_real"
        declared = f"BTE_CAL {kind} {_declared(name, values)}"
        begins = initial(values, how.floating)
        yield f"extern {declared};\nBTE_CAL_DATA {declared} = {begins};"
    body = "\n".join(f"    .{name} = {initial(x, how.floating)}," for name, x in car.items())
    yield f"const bte_car bte_this_car = {{\n{body}\n}};\n"


def _source(name: str) -> Template:
    return Template((SOURCE / name).read_text(encoding="utf-8"))


def code_grids(table: Table, first: str, how: Precision, most_axes: int = MOST_AXES) -> list[Grid]:
    """The maps that the code reads, by the labels of every other format, behind ``first``.

    Sliced where they have more axes. Raises ExchangeError as `Precision`.
    """
    read = {*(name for name, _ in PADS), *SLIP, *LEVEL}
    of = maps_of(table, first, replace(how, code=True), most_axes)
    return [grid for _, grids in of for grid in grids if grid.column in read]


def axes_of(grids: Iterable[Grid]) -> list[Axis]:
    """Each axis of maps once."""
    return [*{axis.label: axis for grid in grids for axis in grid.axes}.values()]


def require_plain(table: Table) -> None:
    """Raise StoreError for effects that the code does not take out."""
    more = [x for x in known_effects(table).described if x not in RESISTANCE]
    if more:
        raise StoreError(
            f"the code does not take out {', '.join(more)}",
            expected=" and ".join(RESISTANCE) + " alone",
            do="hand out the table in another format, and take the effect out before it is read",
        )


def cell(how: Precision) -> str:
    """Type of the cells of the maps in C."""
    return f"int{how.bits}_t" if how.bits else "bte_real"


def _numbers(c: Constants, table: Table, sample_time: float, code: str) -> dict[str, _Member]:
    """Numbers of `bte_car`: tuned ones, those that the code reads; of axles as [front, rear]."""
    car, known = table.vehicle, known_effects(table).parameters
    low, high, change = (x.tolist() for x in limits(sample_time))
    drag, rolling = known[DRAG[0]], known[ROLLING[0]]
    on_ramp, axles = front_share(car, table.calibration.pad_log_ratio.value), (car.front, car.rear)
    lever = car.cg_height / car.wheelbase
    lift = (1.0 - drag.get("load_share", 1.0)) * lever / car.weight
    read = re.findall(r"\b(?:c|car)->(\w+)", code)
    return {name: x for name, x in vars(c).items() if name in read and isinstance(x, float)} | {
        "low": low, "high": high, "change": change,  # what a sensor reads, and from call to call
        "sample_time": sample_time, "rests": _RESTS,
        "lateral_part": 1.0 - math.exp(-sample_time / LATERAL_TIME),  # of a sample in its low pass
        "weight": car.weight,  # [N]
        "load": [float(load[0]) / car.weight for load in axle_loads(car, np.zeros(1))],  # at rest
        "height": [lever, -lever],  # load that moves at 1 g
        "track_width": car.track_width, "cg_height": car.cg_height,  # [m]
        "drag": 0.5 * AIR_DENSITY * drag[DRAG[1]],  # over the square of the speed [N s^2/m^2]
        "drag_lift": [-lift, lift],  # load that moves by it [1/N]
        "rolling": rolling[ROLLING[1]],  # resistance over load, and how it grows with v^2
        "rolling_growth": rolling.get("rolling_growth", 0.0),
        "radius": [axle.rolling_radius for axle in axles],  # [m]
        "turning_mass": [car.weight / G * x for x in turning_shares(car)],  # at the road [kg]
        "rolls": car.weight * (1.0 + sum(turning_shares(car))),  # weight, and of what turns [N]
        "torque_gain": [axle.torque_gain for axle in axles],  # of a wheel, over p and mu [m^3]
        "force": sum(force_per_pressure(car)),  # of both axles with these pads [N/Pa]
        "share": front_share(car, 0.0),  # of the front axle in it
        "ramp_share": [on_ramp, 1.0 - on_ramp],  # of the axles in it with the pads of the ramp
    }  # fmt: skip


def _maps(grids: Iterable[Grid]) -> dict[str, _Member]:
    """Members of `bte_car` that are maps, each of some columns over as many axes."""
    of, ratio, maps = {(g.column, len(g.axes)): g for g in grids}, [x for x, _ in PADS], {}
    for name, columns, axes in (
        ("pads", ratio, 3), ("slip", SLIP, 2), ("level", LEVEL, 1), ("before", ratio, 1)
    ):  # fmt: skip
        made = [of[x, axes] for x in columns]
        places = [[axis.label, len(axis.values)] for axis in made[0].axes]
        steps = [x.fixed.step if x.fixed else 1.0 for x in made]
        maps[name] = [places, axes, len(made), [x.label for x in made], steps]
    return maps


def _enumeration(rows: Iterable[tuple[str, str]]) -> str:
    return "\n".join(f"    BTE_{name.upper()}, /* {meaning} */" for name, meaning in rows)


def _structures(state: Iterable[_Member]) -> Iterator[str]:
    """Definitions of the structures of which a state has members, each once."""
    for of in {type(x): x for x in state if is_dataclass(x)}.values():
        members = fill(", ".join(x.name for x in fields(of)), 80)
        body = indent(f"bte_real {members};", 4 * " ")
        yield f"typedef struct {{\n{body}\n}} {structure(type(of).__name__)};"


def _kind(x: _Member) -> str:
    if is_dataclass(x):
        return structure(type(x).__name__)
    return "bool" if isinstance(x, bool) else "bte_real"


def _declared(name: str, x: _Member) -> str:
    return f"{name}[{len(x)}]" if isinstance(x, list | tuple) else name


def initial(x: _Member, bits: int) -> str:
    """The initial value of a member in C, to the last bit of a floating point of ``bits``."""
    if is_dataclass(x) and not isinstance(x, type):
        x = asdict(x)
    if isinstance(x, dict):
        return f"{{{', '.join(f'.{name} = {initial(y, bits)}' for name, y in x.items())}}}"
    if isinstance(x, list | tuple):
        return f"{{{', '.join(initial(y, bits) for y in x)}}}"
    if not isinstance(x, float):
        return str(x).lower() if isinstance(x, bool) else str(x)
    return f"{np.float32(x)!s}F" if bits == 32 else repr(float(x))
