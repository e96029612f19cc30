"""What the figures of a run are taken from."""

from collections.abc import Sequence
from dataclasses import dataclass

from calib.run.accelerometer import Accelerometer
from calib.run.brake_response import BrakeResponse
from calib.run.run import Run


@dataclass(frozen=True)
class Evidence:
    """A ``run``, with a vehicle or without, and what is known of it beside.

    ``accelerometer`` as judged over the run with a known resistance; ``response`` of its brakes to
    the pressure; ``straight`` runs of the same car on a straight road; ``levels`` of the brakes in
    other logs of a diagnosis, over the file's pads [1].
    """

    run: Run
    accelerometer: Accelerometer | None = None
    response: BrakeResponse | None = None
    straight: Sequence[Run] = ()
    levels: Sequence[float] = ()
