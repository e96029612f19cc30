"""A validation in words: the verdict, what the pads did, how well it is known, what comes next."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import Z95
from calib.estimation.axle_estimate import AxleEstimate
from calib.estimation.limits import Judgement
from calib.estimation.metrics import METRICS
from calib.estimation.validate import CALIBRATION, NO_HOLDOUT, Validation, agreement
from calib.estimation.warnings import pads_apart
from calib.store.state import DRAFT
from calib.store.version import Stored

Array = NDArray[np.float64]
Change = tuple[float, float]
"""Change of a pad friction since the ramp and half width of its 95 % interval, logarithmic [1]."""


def lines(result: Validation) -> list[str]:
    """Two or three sentences on one log, each a line."""
    if result.role == CALIBRATION:
        return [f"{result.log}: no verdict: {NO_HOLDOUT}"]
    first, *others = sentences(result)
    return [f"{result.log}: {text}" for text in (f"{result.verdict}: {first}", *others)]


def sentences(result: Validation) -> list[str]:
    """What the pads did, how well that is known, and which limits are not held, if any."""
    return [text for text in (_pads(result), _known(result), "; ".join(broken(result))) if text]


def word(result: Validation) -> str:
    """The verdict on one log in a word or two."""
    if result.role == CALIBRATION:
        return "no hold-out"
    return result.verdict + _with_warnings(len(result.all_warnings))


def conclusion(stored: Stored, results: Sequence[Validation]) -> str:
    """The verdict on the table by all logs, and what comes next."""
    verdict = "passed" if all(result.passed for result in results) else "failed"
    return f"{verdict}: {outcome(stored, results)}"


def outcome(stored: Stored, results: Sequence[Validation]) -> str:
    """How many logs are within the limits, and what comes next."""
    passed = sum(result.passed for result in results)
    head = f"{_of(passed, len(results))} within the limits"
    if passed == len(results):
        head += _with_warnings(sum(len(result.all_warnings) for result in results), ", with ")
        return f"{head}; {_next(stored, results)}"
    if any(result.role == CALIBRATION for result in results):
        return f"{head}; next: validate again without the logs of the fit"
    failed = ", ".join(result.log for result in results if not result.passed)
    return f"{head}, not {failed}; next: look at it with `brake-cal check` and `brake-cal plot`"


def _next(stored: Stored, results: Sequence[Validation]) -> str:
    """What comes next where all logs are within the limits: a release where nothing is against it.

    Stops with other pads than the ramp's prove nothing of its table.
    """
    together = agreement(list(results))
    if together is not None and together.differ:
        return (
            "next: find out why the pads differ between the stops of one road, and validate again; "
            f"they do not speak for a release of {stored.id}"
        )
    if stored.state.word != DRAFT:
        return f"{stored.id} is {stored.state.word}"
    if any(result.all_warnings for result in results):
        return (
            "next: look at the warnings; where they do not speak against the table, `brake-cal "
            f"tables release {stored.id} --reason ... --evidence DIR/summary.json`"
        )
    return (
        f"next: `brake-cal tables release {stored.id} --reason ... "
        "--evidence DIR/summary.json`, with the DIR of --out"
    )


def on_the_way(result: Validation) -> list[str]:
    """What happened in a run that its brakes did not do: changes of the surface, bumps."""
    split = result.estimate.split
    return [
        *(f"the surface changed at {time:.2f} s" for time in split.changes),
        *(
            f"{start:.2f} to {end:.2f} s tells nothing of the split: wheels or a_x are thrown about"
            ", as over a bump"
            for start, end in split.bumps
        ),
    ]


def on_roads(results: Sequence[Validation]) -> list[tuple[str, str]]:
    """Of each road with several stops: their names, and how far their pads are apart."""
    together = agreement(list(results))
    return [
        (
            ", ".join(road.stops),
            "on roads alike, pad friction differs from the mean by up to "
            f"{100.0 * road.spread_f:.1f} % front and {100.0 * road.spread_r:.1f} % rear",
        )
        for road in (together.roads if together else ())
        if road.spread_f is not None and road.spread_r is not None
    ]


def _with_warnings(count: int, joined: str = ", ") -> str:
    """`, 2 warnings`; nothing where there are none."""
    return f"{joined}{count} warning{'s' * (count > 1)}" if count else ""


def _of(passed: int, all_: int) -> str:
    if passed == all_:
        return "the log is" if all_ == 1 else f"all {all_} logs are"
    return f"{passed} of {all_} logs {'is' if passed == 1 else 'are'}"


def _pads(result: Validation) -> str:
    """The pads against those of the ramp."""
    e = result.estimate
    if not e.valid.any():
        return "no sample of it is valid, so it says nothing of the pads"
    front, rear = change_of(e.front, e.valid), change_of(e.rear, e.valid)
    apart, sigma = pads_apart(e)
    if abs(apart) > Z95 * sigma:
        return f"front pads {_against(front)}, rear pads {_against(rear)} those of the ramp"
    both = (0.5 * (front[0] + rear[0]), max(front[1], rear[1]))
    as_far = f"front and rear alike (their ratio is known to {_percent(Z95 * sigma)})"
    return f"pads {_against(both)} those of the ramp, {as_far}"


def change_of(axle: AxleEstimate, valid: NDArray[np.bool_]) -> Change:
    """Median change of the pads over the valid samples, and its half width."""
    change = np.log(axle.change[valid])
    half = 0.5 * np.log(axle.change_upper[valid] / axle.change_lower[valid])
    return float(np.median(change)), float(np.median(half))


def _against(change: Change) -> str:
    """`20 % below`, `as`, with what they are known to.

    >>> _against((math.log(0.8), 0.03)), _against((0.01, 0.03))
    ('20 +- 2 % below', 'within 3 % of')
    """
    value, half = change
    if abs(value) <= half:
        return f"within {_percent(half)} of"
    size = 100.0 * abs(math.expm1(value))
    known = 100.0 * math.exp(value) * half
    return f"{size:.0f} +- {max(known, 1.0):.0f} % {'below' if value < 0.0 else 'above'}"


def _known(result: Validation) -> str:
    """How well the pad friction itself is known, and how much of the braking is valid."""
    f = result.figures
    parts = []
    if f["interval_f"] is not None and f["interval_r"] is not None:
        widths = f"{_percent(f['interval_f'])} front and {_percent(f['interval_r'])} rear"
        parts.append(f"their friction is known to {widths}")
    if f["torque_error_f"] is not None and f["torque_error_r"] is not None:
        off = f"{_percent(f['torque_error_f'])} front and {_percent(f['torque_error_r'])} rear"
        parts.append(f"the torque is off the truth by {off}")
    parts.append(f"{100.0 * (f['valid_share'] or 0.0):.0f} % of the braking is valid")
    return "; ".join(parts)


def broken(result: Validation) -> list[str]:
    """Each limit that is not held, in words."""
    return [_broken(one) for one in result.judgements if one.passed is False]


def _broken(one: Judgement) -> str:
    """Meaning and value of a metric that breaks its limit, and the limit."""
    meaning = METRICS.get(one.figure, one.figure).removesuffix(" [1]")
    if one.value is None:
        return f"{meaning} is not known, and it is required"
    below = one.low is not None and one.value < one.low
    bound = f"at least {one.low:g}" if below else f"at most {one.high:g}"
    return f"{meaning} is {one.value:.3g}, {bound}"


def _percent(share: float) -> str:
    """A share as a percentage of one or two digits.

    >>> _percent(0.0732), _percent(0.004)
    ('7 %', '0.4 %')
    """
    percent = 100.0 * abs(share)
    return f"{percent:.0f} %" if percent >= 1.0 else f"{percent:.1f} %"
