"""Find the mistakes that explain a ramp better than pads, tyres and car alone do.

    ln odds = ln prior odds + ln evidence - ln evidence of no mistake

See `calib.fitting.evidence` for the evidence and `calib.fitting.hypotheses` for the list.

A mistake is named only where it explains the ramp well, and better than other pads do. Two mistakes
at once are not considered, and a wrong gain of p_mc looks like other pads.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from calib.base.intervals import CERTAIN_LOG_ODDS, LIKELY_LOG_ODDS
from calib.base.names import AXLE_NAMES
from calib.base.units import BAR
from calib.base.warning import Measured
from calib.car.vehicle import Vehicle
from calib.fitting.evidence import NEVER, SCREENING_ERROR, Cause, Evidence
from calib.fitting.hypotheses import (
    DRAG,
    LATE,
    MOTOR,
    SCALE,
    USUAL_PADS,
    VALVE,
    Hypothesis,
    hypotheses,
)
from calib.model.ramp import RampRun

_EXPLAINED = 2.5
"""Mean square of the best residuals of eta, slip and sum over their errors, above which no
hypothesis explains the ramp."""

_MOSTLY = 8.0  # largest such mean square that counts where "nothing wrong" leaves 2.5 times as much

_IN_WORDS = {
    MOTOR: "a motor that brakes the {axle} wheels by up to {size:.0f} N m, and is not logged",
    LATE: "wheel speeds of the {axle} axle that are late by {size:.3f} s",
}


def causes_of(car: Vehicle, runs: Sequence[RampRun], other_road: bool = False) -> tuple[Cause, ...]:
    """The hypotheses on ``runs`` with their odds over "nothing wrong", most probable first.

    The runs are ramps, or stops that may be on an ``other_road``; both axles brake in them. Raises
    ValueError where a run has no usable block.
    """
    evidence = Evidence(car, runs, other_road)
    all_hypotheses = (Hypothesis("", 1.0), *hypotheses(car, runs))
    pads = [evidence.of_pads(h) for h in all_hypotheses if not h.code]
    nothing = pads[0].log_odds
    screened = evidence.screened([h for h in all_hypotheses if h.code], pads)
    threshold = _threshold(pads, screened, other_road)
    unlikely = [c for c in screened if c.log_odds <= threshold]
    likely = [c.hypothesis for c in screened if c.log_odds > threshold]
    mistakes = evidence.of_mistakes(likely, nothing, nothing - SCREENING_ERROR)
    causes = (*pads, *unlikely, *mistakes)
    compared = (replace(cause, log_odds=cause.log_odds - nothing) for cause in causes)
    return tuple(sorted(compared, key=lambda cause: -cause.log_odds))


def _threshold(pads: Sequence[Cause], screened: Sequence[Cause], other_road: bool) -> float:
    """ln of the odds above which a screened mistake is computed with all draws.

    It is infinite on an ``other_road`` where no mistake explains the run better than other pads do.
    """
    best = max(pads, key=lambda cause: cause.log_odds)
    best_mistake = max((cause.log_odds for cause in screened), default=NEVER)
    if other_road and best_mistake < best.log_odds + LIKELY_LOG_ODDS - SCREENING_ERROR:
        return math.inf
    return (
        max(best.log_odds, best_mistake) - LIKELY_LOG_ODDS * max(best.misfit, 1.0) - SCREENING_ERROR
    )


def _candidates(causes: Sequence[Cause]) -> tuple[Cause, ...]:
    """Hypotheses that the ramps cannot tell apart, most probable first.

    There are none where "nothing wrong" is as probable, or where no hypothesis explains the ramps.
    """
    best = causes[0]
    decisive = LIKELY_LOG_ODDS * max(best.misfit, 1.0)  # a misfit makes the odds less certain
    near = tuple(c for c in causes if c.log_odds > best.log_odds - decisive)
    usual = (USUAL_PADS, USUAL_PADS)
    nothing = next(c.misfit for c in causes if not c.hypothesis.code and c.hypothesis.pads == usual)
    largest_misfit = max(_EXPLAINED, min(_MOSTLY, nothing / 2.5))
    return near if best.misfit < largest_misfit and best.log_odds > decisive else ()


def named(causes: Sequence[Cause], beside_pads: bool = True) -> tuple[Cause, ...]:
    """The mistakes that explain the runs, most probable first.

    With ``beside_pads`` they are named even where other pads explain the runs as well: on ramps,
    whose pads are those of the file. Pads of a stop may be wet.
    """
    near = _candidates(causes)
    mistakes = tuple(c for c in near if c.hypothesis.code)
    return mistakes if beside_pads or len(mistakes) == len(near) else ()


def certain(causes: Sequence[Cause]) -> bool:
    """Whether the ramps certainly hold a mistake: no pads explain them as well."""
    near = _candidates(causes)
    without_pads = bool(near) and all(c.hypothesis.code for c in near)
    return without_pads and near[0].log_odds > CERTAIN_LOG_ODDS


def other_than_pads(causes: Sequence[Cause]) -> str:
    """A mistake, in words, that explains the ramps nearly as well as other pads do; else ""."""
    best_pads = max(c.log_odds for c in causes if not c.hypothesis.code)
    for cause in causes:
        code, axle = cause.hypothesis.code, cause.hypothesis.axle
        if code in _IN_WORDS and cause.log_odds > best_pads - LIKELY_LOG_ODDS:
            return _IN_WORDS[code].format(axle=AXLE_NAMES[axle], size=cause.size[0])
    return ""


def measured(causes: Sequence[Cause], beside_pads: bool = True) -> Iterator[Measured]:
    """Yield the mistakes that are named, as figures of `rules.csv`."""
    for cause in named(causes, beside_pads):
        code, axle, size = cause.hypothesis.code, cause.hypothesis.axle, cause.size
        value, words = size[0], {"axle": AXLE_NAMES[axle], "channel": f"T_drive_{axle}"}
        if code == SCALE:
            words |= {"factor": f"{value:.3g}", "cause": _why(value)}
        elif code == DRAG:
            value /= BAR
        elif code in (MOTOR, VALVE):
            pressure = size[1] if code == MOTOR else size[0]
            words["bar"] = f"{pressure / BAR:.0f}"
        yield Measured(code, 1.0 if code == VALVE else value, words=words)


def _why(factor: float) -> str:
    """Likely reason, in words, for a factor that corrects the logged torque at the wheels."""
    if factor < 0.0:
        return "another sign: what slows the car is negative"
    if factor < 1.0:
        return "a torque that is asked for, not the one that acts"
    several = "one motor of several, where the torque of all is meant"
    shaft = "the torque at the shaft of a motor, where that at the wheels is meant"
    return several if factor < 3.5 else shaft
