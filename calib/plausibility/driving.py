"""Figures of how a run was driven: clock, speed, rolling before the brake, the ramp, ABS.

The column `figure` of `rules.csv` names the public function here that measures a rule.
"""

import math
from collections.abc import Iterator

from calib.base.warning import LIMITS, Measured, bounds_of
from calib.plausibility.evidence import Evidence
from calib.run.run import Run

_RAMP_TIME, _RAMP_RISE, _SPAN, _SPAN_ALONE = (
    bounds_of(code)[0] for code in ("ramp_time", "ramp_rise", "ramp_span", "ramp_span_alone")
)
"""Shortest braking and rise of a ramp [s]; least rise of its z [g], with both axles and one."""


def clock(evidence: Evidence) -> Iterator[Measured]:
    """Rate, jitter and gaps."""
    run, sampling = evidence.run, evidence.run.clock
    yield Measured("clock_rate", sampling.rate)
    yield Measured("clock_jitter", sampling.jitter * sampling.rate)
    longest_gap = max((length for _, length in sampling.gaps), default=0.0)
    starts = [run.log.time[0], *(start + length for start, length in sampling.gaps)]
    ends = [*(start for start, _ in sampling.gaps), run.log.time[-1]]
    start, end = max(zip(starts, ends, strict=True), key=lambda part: part[1] - part[0])
    words = {"count": len(starts), "start": start, "end": end, "log": run.log.source}
    yield Measured("clock_gaps", longest_gap, words=words)


def driving(evidence: Evidence) -> Iterator[Measured]:
    """Speed, lead-in, ABS and locked wheels."""
    run = evidence.run
    yield Measured("too_slow", run.speed)
    if run.events:
        yield Measured("lead_in", run.lead_in)
    yield from _wheels_at_limit(run, "abs", "locked_wheels")


def maneuver(evidence: Evidence) -> Iterator[Measured]:
    """Requirements of a ramp, a stop and a coast."""
    run = evidence.run
    if run.missing:
        return
    yield Measured("no_braking", float(not run.events))
    yield Measured("braked_coast", float(bool(run.events)))
    if not run.events:
        yield Measured("coasting", run.coasting)
        return
    yield Measured("begins_braked", float(run.events[0].first_sample == 0))
    if not (run.slipping and run.slipping.locked):  # locked wheels do not show the speed
        yield Measured("braking_time", sum(event.braking_time for event in run.events))
    yield from _ramp(run)
    change = run.axles.eta_most if run.axles else None  # a table is a curve over eta
    if change is not None:
        is_alike = max(abs(change.value), change.half) < LIMITS.eta_alike
        precision = abs(change.value) / max(change.half, 1e-12)
        yield Measured("eta_alike" if is_alike else "eta_unknown", precision)


def _ramp(run: Run) -> Iterator[Measured]:
    """The widest ramp of a run, else its widest rise, and what disturbs it."""
    is_alone = run.alone is not None
    ramps = [x for x in run.events if x.braking_time >= _RAMP_TIME and x.rise_time >= _RAMP_RISE]
    ramp = max(ramps, key=lambda event: event.rise_z, default=None)
    if ramp is None or ramp.rise_z < (_SPAN_ALONE if is_alone else _SPAN):
        ramp = max(run.events, key=lambda event: event.rise_z)
    yield Measured("ramp_rise", ramp.rise_time)
    yield Measured("ramp_time", ramp.braking_time)
    in_pieces = ramp.z_high - ramp.z_low > 1.2 * ramp.rise_z
    how = f"the braking reaches {ramp.z_high:.2f} g, but not in one rise" if in_pieces else ""
    code = "ramp_span_alone" if is_alone else "ramp_span"
    yield Measured(code, ramp.rise_z, words={"how": how})
    yield from _wheels_at_limit(run, "abs_in_ramp", "locked_in_ramp", ramp.start, ramp.end)
    for start, length in run.clock.gaps:
        if ramp.start <= start <= ramp.end:
            yield Measured("gap_in_ramp", length, words={"when": start})


def _wheels_at_limit(
    run: Run, abs_code: str, locked_code: str, start: float = -math.inf, end: float = math.inf
) -> Iterator[Measured]:
    """Number of ABS cycles from ``start`` to ``end`` [s], and of wheels that lock in the run."""
    if run.slipping is None:
        return
    cycles = [(wheel, time) for wheel, time in run.slipping.cycles if start <= time <= end]
    wheels = ", ".join(dict.fromkeys(wheel for wheel, _ in cycles))
    first = cycles[0][1] if cycles else 0.0
    yield Measured(abs_code, len(cycles), words={"wheels": wheels, "when": first})
    locked = run.slipping.locked
    yield Measured(locked_code, len(locked), words={"wheels": ", ".join(locked)})
