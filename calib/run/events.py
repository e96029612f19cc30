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
    """Return the events in order of time; none without ``a_x`` and the four wheel speeds.

    Of a lead-in with gaps the longest part counts.
    """
    run = Run(log)
    if not run.has_motion_channels:
        return ()
    brakings = true_intervals(run.driving.braked)
    lead_in = true_intervals(run.rolling)
    lengths = [log.time[end - 1] - log.time[start] for start, end in lead_in]
    longest = [lead_in[int(np.argmax(lengths))]] if lead_in else []
    stands = np.max([log[name] for name in WHEEL_SPEEDS], axis=0) < LIMITS.standing
    spans = {
        LEAD_IN: longest,
        BITES: [(start, start + 1) for start, _ in brakings],
        BRAKING: brakings,
        STANDSTILL: true_intervals(stands),
    }
    events = [
        RunEvent(kind, float(log.time[start]), float(log.time[end - 1]))
        for kind, intervals in spans.items()
        for start, end in intervals
    ]
    return tuple(sorted(events, key=lambda event: event.start))
