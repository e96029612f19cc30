"""Events of a run: its lead-in, bites, brakings and standstills, in order of time."""

from dataclasses import dataclass

from calib.logs.log import Log
from calib.run.driving_record import standing
from calib.run.filters import runs
from calib.run.run import Run

LEAD_IN, BITES, BRAKING, STANDSTILL = "lead-in", "bite", "braking", "standstill"


@dataclass(frozen=True)
class RunEvent:
    """A lead-in, bite, braking or standstill, from ``start`` to ``end`` [s]; a bite is a moment."""

    kind: str
    start: float
    end: float


def run_events(log: Log) -> tuple[RunEvent, ...]:
    """The events in order of time; none without ``a_x`` and the four wheel speeds.

    Brakings are those of `check`; the lead-in is its longest part.
    """
    run = Run(log)
    if not run.moves:
        return ()
    rolling = sorted(runs(run.rolling), key=lambda part: log.time[part[0]] - log.time[part[1] - 1])
    brakings = runs(run.driving.braked)
    spans = {
        LEAD_IN: rolling[:1],
        BITES: [(start, start + 1) for start, _ in brakings],
        BRAKING: brakings,
        STANDSTILL: runs(standing(log)),
    }
    events = [
        RunEvent(kind, float(log.time[start]), float(log.time[end - 1]))
        for kind, each in spans.items()
        for start, end in each
    ]
    return tuple(sorted(events, key=lambda event: event.start))
