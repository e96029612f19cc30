"""The run, and the knowledge from beyond its log, from which its figures are computed."""

from collections.abc import Sequence
from dataclasses import dataclass

from calib.run.accelerometer import Accelerometer
from calib.run.brake_response import BrakeResponse
from calib.run.run import Run


@dataclass(frozen=True)
class Evidence:
    """A run, and results that need a vehicle or other runs."""

    run: Run
    accelerometer: Accelerometer | None = None  # errors of a_x, with a known resistance
    response: BrakeResponse | None = None
    straight: Sequence[Run] = ()  # runs of the same car on a straight road
    levels: Sequence[float] = ()  # pads of the other logs of a diagnosis over the file's [1]
