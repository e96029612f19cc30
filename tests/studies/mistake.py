"""One mistake at a station, and the places where it may sit: vehicle file, runs, logs."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from tests.studies.made_lines import Line, Run
from tests.support.plant import Plant

Rng = np.random.Generator
Logs = dict[str, Log]
Make = Callable[[Rng], "Mistake"]
"""Draws a mistake."""


@dataclass(frozen=True)
class Mistake:
    """One mistake of one size: the line that it makes of a good one, and the logs."""

    size: str
    line: Callable[[Line], Line] = lambda line: line
    logs: Callable[[Logs], Logs] = lambda logs: logs


def in_file(change: Callable[[Vehicle], Vehicle]) -> Callable[[Line], Line]:
    """A change of the vehicle file."""
    return lambda line: replace(line, file=change(line.file))


def in_runs(names: Iterable[str], change: Callable[[Run], Run]) -> Callable[[Line], Line]:
    """A change of what happens in some runs."""
    return lambda line: replace(
        line, runs={**line.runs, **{name: change(line.runs[name]) for name in names}}
    )


def in_car(names: Iterable[str], change: Callable[[Plant], Plant]) -> Callable[[Line], Line]:
    """A change of what the car and the road are in some runs."""
    return in_runs(names, lambda run: replace(run, plant=change(run.plant)))


def in_channel(
    names: Iterable[str], channel: str, change: Callable[[np.ndarray, Log], np.ndarray]
) -> Callable[[Logs], Logs]:
    """A change of one channel in some logs."""

    def changed(logs: Logs) -> Logs:
        out = dict(logs)
        for name in names:
            log = logs[name]
            if channel in log:
                new = {**log.channels, channel: change(log[channel], log)}
                out[name] = replace(log, channels=new)
        return out

    return changed


def off_by(rng: Rng, low: float, high: float) -> float:
    """A factor that is wrong by ``low`` to ``high`` [1], up or down."""
    return 1.0 + float(rng.choice([-1.0, 1.0])) * float(rng.uniform(low, high))


def percent(factor: float) -> str:
    """The error of a factor."""
    return f"{100 * (factor - 1):+.0f} %"
