"""Evidence for the figures of a run."""

from collections.abc import Sequence
from dataclasses import dataclass

from calib.run.accelerometer import Accelerometer
from calib.run.brake_response import BrakeResponse
from calib.run.run import Run


@dataclass(frozen=True)
class Evidence:
    """Inputs of the figures of a ``run``.

    ``accelerometer`` with a known resistance; ``straight`` runs of the same car on a straight road;
    ``levels`` of the brakes in the other logs of a diagnosis, over the pads of the file [1].
    """

    run: Run
    accelerometer: Accelerometer | None = None
    response: BrakeResponse | None = None
    straight: Sequence[Run] = ()
    levels: Sequence[float] = ()
