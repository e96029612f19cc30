"""Events of a log in order of time: its lead-in, bites, brakings and standstills."""

from dataclasses import dataclass

import numpy as np

from calib.base.names import WHEEL_SPEEDS
from calib.base.warning import LIMITS
from calib.logs.log import Log
from calib.run.filters import true_intervals
from calib.run.run import Run

LEAD_IN, BITES, BRAKING, STANDSTILL = "lead-in", "bite", "braking", "standstill"


@dataclass(frozen=True)
class RunEvent:
    """An event of a ``kind`` above, from ``start`` to ``end`` [s]; a bite is a moment."""

    kind: str
    start: float
    end: float


def run_events(log: Log) -> tuple[RunEvent, ...]:
    """Return the events in order of time; none without ``a_x`` and the four wheel speeds."""
    run = Run(log)
    if not run.has_motion_channels:
        return ()

    def events(kind: str, intervals: list[tuple[int, int]]) -> list[RunEvent]:
        times = [(float(log.time[start]), float(log.time[end - 1])) for start, end in intervals]
        return [RunEvent(kind, start, end) for start, end in times]

    rolling = events(LEAD_IN, true_intervals(run.rolling))
    lead_ins = [max(rolling, key=lambda event: event.end - event.start)] if rolling else []
    brakings = true_intervals(run.driving.braked)
    bites = events(BITES, [(start, start + 1) for start, _ in brakings])
    stands = np.max([log[name] for name in WHEEL_SPEEDS], axis=0) < LIMITS.standing
    standstills = events(STANDSTILL, true_intervals(stands))
    all_events = [*lead_ins, *bites, *events(BRAKING, brakings), *standstills]
    return tuple(sorted(all_events, key=lambda event: event.start))
