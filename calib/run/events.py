r"""The events of a run: lead-in, bite, braking, standstill.

speed   ~~~~~~~\
                    \\______
lead-in|braking|standstill
^ bite
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.logs.log import Log
from calib.run.driving_record import brake_events, driving_record, rolls
from calib.run.filters import runs
from calib.run.limits import LIMITS

LEAD_IN, BITE, BRAKING, STANDSTILL = "lead-in", "bite", "braking", "standstill"
KINDS = (LEAD_IN, BITE, BRAKING, STANDSTILL)
NEEDED = ("a_x", *(f"omega_{wheel}" for wheel in WHEELS))
"""Channels without which no event is known."""


@dataclass(frozen=True)
class RunEvent:
    """An event of one of the `KINDS`, from ``start`` to ``end`` [s]; a bite has no length."""

    kind: str
    start: float
    end: float


def run_events(log: Log) -> tuple[RunEvent, ...]:
    """The events in order of time; none without the channels of `NEEDED`.

    The lead-in is the longest steady, unbraked rolling before the first braking. Brakings are those
    of `check`: by the pressure, or by the deceleration where there is none.
    """
    if any(name not in log for name in NEEDED):
        return ()
    return tuple(sorted(_events(log), key=lambda event: (event.start, KINDS.index(event.kind))))


def _events(log: Log) -> Iterator[RunEvent]:
    driving = driving_record(log)
    rolling = driving.lead_in & driving.moving & rolls(driving.z)
    spans = _spans(log, rolling)
    if spans:
        yield RunEvent(LEAD_IN, *max(spans, key=lambda span: span[1] - span[0]))
    for event in brake_events(driving):
        yield RunEvent(BITE, event.start, event.start)
        yield RunEvent(BRAKING, event.start, event.end)
    wheels = np.max([log[f"omega_{w}"] for w in WHEELS], axis=0)
    for span in _spans(log, wheels < LIMITS.standing):
        yield RunEvent(STANDSTILL, *span)


def _spans(log: Log, where: NDArray[np.bool_]) -> list[tuple[float, float]]:
    return [(float(log.time[i]), float(log.time[j - 1])) for i, j in runs(where)]
