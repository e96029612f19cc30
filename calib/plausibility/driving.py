"""Figures of how a run was driven: speed, rolling before the brake, the ramp, ABS.

Each function is a figure of `rules.csv` by its name.
"""

import math
from collections.abc import Iterator

from calib.base.warning import LIMITS, Measured, bounds_of
from calib.plausibility.evidence import Evidence
from calib.run.run import Run


def clock(e: Evidence) -> Iterator[Measured]:
    """Rate, jitter and gaps."""
    sampling, time = e.run.clock, e.run.log.time
    yield Measured("clock_rate", sampling.rate)
    yield Measured("clock_jitter", sampling.jitter * sampling.rate)
    longest = max((length for _, length in sampling.gaps), default=0.0)
    gaps = [(start, start + length) for start, length in sampling.gaps]
    starts, ends = [time[0], *(end for _, end in gaps)], [*(start for start, _ in gaps), time[-1]]
    start, end = max(zip(starts, ends, strict=True), key=lambda part: part[1] - part[0])
    words = {"count": len(gaps), "start": start, "end": end, "log": e.run.log.source}
    yield Measured("clock_gaps", longest, words=words)


def driving(e: Evidence) -> Iterator[Measured]:
    """Speed, lead-in, ABS and locked wheels."""
    run = e.run
    yield Measured("too_slow", run.speed)
    if run.events:
        yield Measured("lead_in", run.lead_in)
    yield from _limits(run, "abs", "locked_wheels")


def use(e: Evidence) -> Iterator[Measured]:
    """Requirements of a ramp, a stop and a coast."""
    run = e.run
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
    if run.axles and (most := run.axles.eta_most):  # a table is a curve over eta
        alike = max(abs(most.value), most.half) < LIMITS.eta_alike
        sure = abs(most.value) / max(most.half, 1e-12)
        yield Measured("eta_alike" if alike else "eta_unknown", sure)


def _ramp(run: Run) -> Iterator[Measured]:
    """The best ramp of a run, else its widest rise, and its disturbances."""
    alone = run.alone is not None
    good = [e for e in run.events if e.braking_time >= _RAMP_TIME and e.rise_time >= _RAMP_RISE]
    ramp = max(good, key=lambda e: e.rise_z, default=None)
    if ramp is None or ramp.rise_z < (_SPAN_ALONE if alone else _SPAN):
        ramp = max(run.events, key=lambda e: e.rise_z)
    yield Measured("ramp_rise", ramp.rise_time)
    yield Measured("ramp_time", ramp.braking_time)
    in_pieces = ramp.z_high - ramp.z_low > 1.2 * ramp.rise_z
    how = f"the braking reaches {ramp.z_high:.2f} g, but not in one rise" if in_pieces else ""
    yield Measured("ramp_span_alone" if alone else "ramp_span", ramp.rise_z, words={"how": how})
    yield from _limits(run, "abs_in_ramp", "locked_in_ramp", ramp.start, ramp.end)
    for when, length in run.clock.gaps:
        if ramp.start <= when <= ramp.end:
            yield Measured("gap_in_ramp", length, words={"when": when})


def _limits(
    run: Run, of_abs: str, of_locked: str, start: float = -math.inf, end: float = math.inf
) -> Iterator[Measured]:
    slips = run.slipping
    cycles = [(wheel, t) for wheel, t in slips.cycles if start <= t <= end] if slips else []
    wheels = ", ".join(dict.fromkeys(wheel for wheel, _ in cycles))
    when = cycles[0][1] if cycles else 0.0
    yield Measured(of_abs, len(cycles), words={"wheels": wheels, "when": when})
    locked = slips.locked if slips else ()
    yield Measured(of_locked, len(locked), words={"wheels": ", ".join(locked)})


_RAMP_TIME, _RAMP_RISE, _SPAN, _SPAN_ALONE = (
    bounds_of(code)[0] for code in ("ramp_time", "ramp_rise", "ramp_span", "ramp_span_alone")
)
