"""Find the mistakes that explain a ramp better than pads, tyres and car alone do.

    ln odds = ln prior odds + ln evidence - ln evidence of no mistake

See `calib.fitting.evidence` for the evidence and `calib.fitting.hypotheses` for the list. A
hypothesis with a code is a mistake; those without are "nothing wrong" and other pads. Mistakes are
screened with few draws, and the likely ones are computed with all.
A mistake is named only where it explains the ramp well, and better than "nothing wrong" does. Two
mistakes at once are not considered, and a wrong gain of p_mc looks like other pads.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from calib.base.intervals import CERTAIN_LOG_ODDS, LIKELY_LOG_ODDS
from calib.base.names import AXLE_NAMES
from calib.base.units import BAR
from calib.base.warning import Measured
from calib.car.vehicle import Vehicle
from calib.fitting.evidence import NEVER, SCREENING_ERROR, Cause, HypothesisEvidence
from calib.fitting.hypotheses import DRAG, LATE, MOTOR, NOTHING_WRONG, SCALE, VALVE, hypotheses
from calib.model.ramp import RampRun

_EXPLAINED, _MOSTLY, _GAIN = 2.5, 8.0, 2.5
"""A hypothesis explains the ramp if its `Cause.misfit` is below `_EXPLAINED`; or below `_MOSTLY`,
and below 1/`_GAIN` of the misfit of "nothing wrong"."""

_IN_WORDS = {
    MOTOR: "a motor that brakes the {axle} wheels by up to {size:.0f} N m, and is not logged",
    LATE: "wheel speeds of the {axle} axle that are late by {size:.3f} s",
}


def causes_of(car: Vehicle, runs: Sequence[RampRun], other_road: bool = False) -> tuple[Cause, ...]:
    """Return the hypotheses on ``runs`` with odds over "nothing wrong", most probable first.

    The runs are ramps, or stops that may be on an ``other_road``; both axles brake in them. Raises
    ValueError where a run has no usable block.
    """
    evidence = HypothesisEvidence(car, runs, other_road)
    all_hypotheses = (NOTHING_WRONG, *hypotheses(car, runs))
    pads = [evidence.cause_of_pads(h) for h in all_hypotheses if not h.code]
    nothing = pads[0].log_odds
    screened = evidence.screened([h for h in all_hypotheses if h.code], pads)
    threshold = _threshold(pads, screened, other_road)
    unlikely = [c for c in screened if c.log_odds <= threshold]
    likely = [c.hypothesis for c in screened if c.log_odds > threshold]
    mistakes = evidence.causes_of(likely, nothing, search_from=nothing - SCREENING_ERROR)
    causes = (*pads, *unlikely, *mistakes)
    compared = (replace(cause, log_odds=cause.log_odds - nothing) for cause in causes)
    return tuple(sorted(compared, key=lambda cause: -cause.log_odds))


def _threshold(pads: Sequence[Cause], screened: Sequence[Cause], other_road: bool) -> float:
    """Return ln of the odds above which a screened mistake is computed with all draws.

    It is infinite on an ``other_road`` where no mistake explains the run clearly better than other
    pads do.
    """
    best_pads = max(pads, key=lambda cause: cause.log_odds)
    best_mistake = max((cause.log_odds for cause in screened), default=NEVER)
    if other_road and best_mistake < best_pads.log_odds + LIKELY_LOG_ODDS - SCREENING_ERROR:
        return math.inf
    best = max(best_pads.log_odds, best_mistake)
    return best - _decisive(best_pads) - SCREENING_ERROR


def _decisive(best: Cause) -> float:
    """Return the difference of ln of the odds that decides: larger if the best one fits badly."""
    return LIKELY_LOG_ODDS * max(best.misfit, 1.0)


def _candidates(causes: Sequence[Cause]) -> tuple[Cause, ...]:
    """Return the hypotheses that the runs cannot tell apart, most probable first.

    There are none where "nothing wrong" is as probable, or where no hypothesis explains the runs.
    """
    best, decisive = causes[0], _decisive(causes[0])
    near = tuple(c for c in causes if c.log_odds > best.log_odds - decisive)
    nothing = next(cause for cause in causes if cause.hypothesis is NOTHING_WRONG)
    largest_misfit = max(_EXPLAINED, min(_MOSTLY, nothing.misfit / _GAIN))
    return near if best.misfit < largest_misfit and best.log_odds > decisive else ()


def named(causes: Sequence[Cause], beside_pads: bool = True) -> tuple[Cause, ...]:
    """Return the mistakes that explain the runs, most probable first.

    With ``beside_pads`` a mistake is named even where other pads explain the runs as well: a ramp
    is driven with the pads of the file. Without it (for stops, whose pads may be wet) a mistake is
    named only where no pads explain them as well.
    """
    near = _candidates(causes)
    mistakes = tuple(c for c in near if c.hypothesis.code)
    return mistakes if beside_pads or len(mistakes) == len(near) else ()


def certain(causes: Sequence[Cause]) -> bool:
    """Whether the ramps certainly hold a mistake: no pads explain them as well."""
    mistakes = named(causes, beside_pads=False)
    return bool(mistakes) and mistakes[0].log_odds > CERTAIN_LOG_ODDS


def other_than_pads(causes: Sequence[Cause]) -> str:
    """Return a motor or late wheels, in words, if nearly as probable as other pads; else ""."""
    best_pads = max(c.log_odds for c in causes if not c.hypothesis.code)
    for cause in causes:
        code, axle = cause.hypothesis.code, cause.hypothesis.axle
        if code in _IN_WORDS and cause.log_odds > best_pads - LIKELY_LOG_ODDS:
            return _IN_WORDS[code].format(axle=AXLE_NAMES[axle], size=cause.size[0])
    return ""


def measured(causes: Sequence[Cause], beside_pads: bool = True) -> Iterator[Measured]:
    """Yield the mistakes that are named, as figures of `rules.csv`."""
    for cause in named(causes, beside_pads):
        code, axle = cause.hypothesis.code, cause.hypothesis.axle
        value, *others = cause.size
        words = {"axle": AXLE_NAMES[axle], "channel": f"T_drive_{axle}"}
        if code == SCALE:
            words |= {"factor": f"{value:.3g}", "cause": _why(value)}
        elif code == DRAG:
            value /= BAR
        elif code == MOTOR:  # value is the torque, the other number the pressure of full torque
            words["bar"] = f"{others[0] / BAR:.0f}"
        elif code == VALVE:  # the rule only asks whether there is one; the knee is in its words
            words["bar"], value = f"{value / BAR:.0f}", 1.0
        yield Measured(code, value, words=words)


def _why(factor: float) -> str:
    """Return the likely reason, in words, for a factor that corrects the logged torque."""
    if factor < 0.0:
        return "another sign: what slows the car is negative"
    if factor < 1.0:
        return "a torque that is asked for, not the one that acts"
    several = "one motor of several, where the torque of all is meant"
    shaft = "the torque at the shaft of a motor, where that at the wheels is meant"
    return several if factor < 3.5 else shaft
