"""`brake-cal plan`: say which runs make the torque better known, before they are driven."""

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from cli.command import FAILED, Answer, command
from cli.console import json_text, progress, usage_error
from cli.logs import read_all
from cli.options import Car, Map, Tables, Workers, in_si, option, require_known
from cli.outputs import check_folder, write_folder

Quantities = dict[str, float]  # by name, in SI


def _quantities(units: dict[str, str], written: str | None) -> Quantities:
    """Return the quantities of a list such as "front 2 %, rear 4 %".

    ``units`` has the SI unit of each known name. A plain number of 1 or more lacks its "%".
    """
    values: Quantities = {}
    parts = written.split(",") if written else []
    for part in parts:
        name, _, text = part.strip().partition(" ")
        if name not in units:
            raise usage_error(f"unknown {name!r}; known: {', '.join(units)}")
        value = in_si(units[name], text.strip())
        if value <= 0.0:
            raise usage_error(f"{part.strip()} must be more than 0")
        if units[name] == "1" and value >= 1.0:
            raise usage_error(f"{part.strip()} is {100.0 * value:g} %; expected such as {name} 2 %")
        values[name] = value
    return values


_WANT = partial(_quantities, {"front": "1", "rear": "1", "total": "1"})
_TRACK = partial(_quantities, {"length": "m", "speed": "m/s"})


def _text(text: str, make: Callable[..., object], *, always: bool = True) -> Any:
    return option(text, "TEXT", typed=str | None, make=make, always=always)


def _sensors(written: str | None) -> frozenset[str]:
    """Return the optional channels that are logged, from a list such as "v,p_fl"."""
    from calib.base.names import WHEEL_PRESSURES

    sensors = ("v", *WHEEL_PRESSURES)
    names = [name.strip() for name in written.split(",")] if written else []
    return frozenset(require_known(name, sensors, "sensor") for name in names)


@command(
    "brake-cal plan --vehicle sample_logs/sedan/vehicle.toml --time '30 s'",
    "brake-cal plan --vehicle sample_logs/sedan/vehicle.toml --want 'front 3 %, rear 6 %' "
    "--sensors v,p_fl,p_fr,p_rl,p_rr --out drive",
    report=True,
)
def plan(
    *,
    vehicle: Car,
    have: list[Path] = option("Log of the car that is there already; repeatable.", "LOG"),
    table: str | None = option("Table of the car, for its pads, tyres and noise.", "TABLE"),
    want: Quantities = _text('What is enough (95 %): "front 2 %, rear 4 %, total 2 %".', _WANT),
    time: float | None = _text('Time to spend, such as "90 s".', partial(in_si, "s"), always=False),
    track: Quantities = _text('Track: "length 300 m, speed 120 km/h", else 100 km/h.', _TRACK),
    sensors: frozenset[str] = _text("What of v, p_fl, p_fr, p_rl, p_rr is logged.", _sensors),
    store: Tables,
    channel_map: Map,
    workers: Workers,
    out: Path | None = option("Folder of plan and pressures.", "DIR", writes="folder"),
) -> Answer:
    """Say which runs make the torque better known, before they are driven.

    Cars that agree with the vehicle file and the logs of --have are simulated and fitted. --report
    writes a page for the driver. Exit code 1 if what is wanted cannot be had.
    """
    from calib.base.processes import cores
    from calib.plan.achieved import DOCUMENT, HalfWidths
    from calib.plan.expected import prior_of
    from calib.plan.files import document, pressure_files
    from calib.plan.measure import Track
    from calib.plan.search import Want
    from calib.plan.search import plan as search

    check_folder(out, [DOCUMENT])
    with progress() as step:
        logs = read_all(have, channel_map, step, more=1)
        step(f"planning runs of {vehicle.name}", len(logs), len(logs) + 1)
        car = store.load(table).table if table else None
        situation = prior_of(vehicle, Track(**track), sensors, car, logs)
        wanted = Want(HalfWidths(**want), time or math.inf)
        result = search(situation, wanted, workers or cores())
    answer = document(result)
    if out is not None:
        files = [*pressure_files(result), (DOCUMENT, json_text(answer).encode())]
        write_folder(out, files, DOCUMENT)
    code = FAILED if want and not answer["met"] else 0
    return Answer(answer, result, code, out=out)
