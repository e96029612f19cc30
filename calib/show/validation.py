"""Facts of a validation: the verdict, what the pads did, how well it is known, what comes next."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.intervals import Z95
from calib.base.names import AXLE_NAMES
from calib.base.plain import plain, signed_percent
from calib.estimation.axle_estimate import AxleEstimate
from calib.estimation.estimator import Estimate
from calib.estimation.validate import (
    CALIBRATION,
    NO_HOLDOUT,
    Validation,
    agreement,
    all_warnings,
)
from calib.estimation.warnings import pads_apart
from calib.show.facts import FAILED, PASSED, WARNING, WORDS, Facts, Picture, Row, Table
from calib.show.judged import broken, judged, pads, word
from calib.show.origin import PageOrigin
from calib.show.origin import origin as origin_of
from calib.show.sheet import Sheet
from calib.show.stop import pads_over_time
from calib.store.state import DRAFT
from calib.store.version import Stored
from calib.table.budget import advice_lines

_Change = tuple[float, float]
"""Change of a pad friction since the ramp and half width of its 95 % interval, logarithmic [1]."""

_BY_STOP = (
    "Stop by stop: pads with 95 % intervals, their change since the ramp, errors of the torque."
)


def facts(stored: Stored, results: Sequence[Validation]) -> Facts:
    """A table judged by logs; each warning that speaks against it is among them."""
    found = list(results)
    warnings = all_warnings(stored.table.warnings, found)
    failed = not all(result.passed for result in found)
    verdict = FAILED if failed else WARNING if warnings else PASSED
    return Facts(
        title=f"Validation of {stored.id}",
        headline=_outcome(stored, found),
        verdict=verdict,
        word=WORDS[verdict],
        tables=[_by_stop(stored, found)],
        rows=[
            ("Table", f"{stored.id}, {stored.state.why}"),
            ("Vehicle", stored.table.vehicle.name),
            ("Mass", str(found[0].mass)),
            *_limiting(found),
        ],
        notes=advice_lines(of for result in found for of in result.limiting or ()),
        warnings=warnings,
    )


def report(stored: Stored, results: Sequence[Validation], origin: PageOrigin) -> Facts:
    """The facts with a part for each stop, and with their origin."""
    logs = [(r.role, r.log, r.digest) for r in results]
    from_ = origin_of(origin, stored, logs, str(results[0].mass))
    return replace(facts(stored, results), parts=[*map(_stop, results), from_])


def _outcome(stored: Stored, results: list[Validation]) -> str:
    """How many logs are within the limits, and what comes next."""
    passed, of = sum(result.passed for result in results), len(results)
    if passed == of:
        counts = "the log is" if of == 1 else f"all {of} logs are"
        return f"{counts} within the limits; {_next(stored, results)}"
    head = f"{passed} of {of} logs {'is' if passed == 1 else 'are'} within the limits"
    if any(result.role == CALIBRATION for result in results):
        return f"{head}; next: validate again without the logs of the fit"
    failed = ", ".join(result.log for result in results if not result.passed)
    return f"{head}, not {failed}; next: look at it with brake-cal check and brake-cal plot"


def _next(stored: Stored, results: list[Validation]) -> str:
    """What comes next where all logs are within the limits: a release where nothing is against it.

    Stops with other pads than the ramp's prove nothing of its table.
    """
    together = agreement(results)
    if together is not None and together.differ:
        return (
            "next: find out why the pads differ between the stops of one road, and validate again; "
            f"they do not speak for a release of {stored.id}"
        )
    if stored.state.word != DRAFT:
        return f"{stored.id} is {stored.state.word}"
    release = f"brake-cal tables release {stored.id} --reason ... --evidence DIR/summary.json"
    if any(result.all_warnings for result in results):
        return (
            "next: look at the warnings; where they do not speak against the table, "
            f"{release}, with the DIR of --out"
        )
    return f"next: {release}, with the DIR of --out"


def _by_stop(stored: Stored, results: list[Validation]) -> Table:
    """Pads with intervals and their change since the ramp, valid samples, errors, verdict."""
    cal = stored.table.calibration
    truth = [f"torque_error_{axle}" for axle in "fr"]
    truth = truth if any(r.figures[truth[0]] is not None for r in results) else []
    rows = []
    for r in results:
        cells = []
        for axle, ramp in (("f", cal.pad_friction_f), ("r", cal.pad_friction_r)):
            mu = r.figures[f"pad_friction_{axle}"]
            cells.append(pads(r.figures, axle) or "not known")
            cells.append("" if mu is None else signed_percent(mu / ramp.value - 1.0))
        cells += [plain(name).with_unit(r.figures[name]) for name in ("valid_share", *truth)]
        rows.append((r.log, *cells, word(r)))
    since = "change"
    errors = ("error, front", "error, rear")[: len(truth)]
    heads = ("stop", "front pads", since, "rear pads", since, "valid", *errors, "verdict")
    return Table(heads, rows, _BY_STOP, [_verdict(r) for r in results])


def _limiting(results: list[Validation]) -> list[Row]:
    """What each log says of the pads; limits that are not held; what the intervals are made of."""
    rows = []
    for r in results:
        rows += [(r.log, text) for text in _sentences(r)]
        rows += [
            (r.log, f"{100.0 * share:.0f} % of the braked samples are not valid: {why}")
            for why, share in r.refused.items()
        ]
        rows += [(r.log, text) for text in on_the_way(r)]
        rows += [
            (f"{r.log}, {name} pads", of.words)
            for name, of in zip(AXLE_NAMES.values(), r.budget or (), strict=False)
        ]
    together = agreement(results)
    return rows + [
        (
            ", ".join(road.stops),
            "on roads alike, pad friction differs from the mean by up to "
            f"{100.0 * road.spread_f:.1f} % front and {100.0 * road.spread_r:.1f} % rear",
        )
        for road in (together.roads if together else ())
        if road.spread_f is not None and road.spread_r is not None
    ]


def _sentences(r: Validation) -> list[str]:
    """What the pads did, and which limits are not held, if any."""
    if r.role == CALIBRATION:
        return [NO_HOLDOUT]
    return [_pads(r.estimate), *broken(r)]


def _verdict(r: Validation) -> str:
    return PASSED if r.passed else FAILED


def on_the_way(r: Validation) -> list[str]:
    """Notes of the estimator, and what happened that the brakes did not do: surfaces, bumps."""
    split = r.estimate.split
    return [
        *r.estimate.notes,
        *(f"the surface changed at {time:.2f} s" for time in split.changes),
        *(
            f"{start:.2f} to {end:.2f} s tells nothing of the split: wheels or a_x are thrown about"
            ", as over a bump"
            for start, end in split.bumps
        ),
    ]


def _pads(e: Estimate) -> str:
    """The pads against those of the ramp."""
    if not e.valid.any():
        return "no sample of it is valid, so it says nothing of the pads"
    front, rear = _change_of(e.front, e.valid), _change_of(e.rear, e.valid)
    apart, sigma = pads_apart(e)
    if abs(apart) > Z95 * sigma:
        return f"front pads {_against(front)}, rear pads {_against(rear)} those of the ramp"
    both = (0.5 * (front[0] + rear[0]), max(front[1], rear[1]))
    as_far = f"front and rear alike (their ratio is known to {_percent(Z95 * sigma)})"
    return f"pads {_against(both)} those of the ramp, {as_far}"


def _change_of(axle: AxleEstimate, valid: np.ndarray) -> _Change:
    """Median change of the pads over the ``valid`` samples (n,), and its half width."""
    change = np.log(axle.change[valid])
    half = 0.5 * np.log(axle.change_upper[valid] / axle.change_lower[valid])
    return float(np.median(change)), float(np.median(half))


def _against(change: _Change) -> str:
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


def _percent(share: float) -> str:
    """A share as a percentage of one or two digits.

    >>> _percent(0.0732), _percent(0.004)
    ('7 %', '0.4 %')
    """
    percent = 100.0 * abs(share)
    return f"{percent:.0f} %" if percent >= 1.0 else f"{percent:.1f} %"


def _stop(r: Validation) -> Facts:
    """One stop: judged metrics, the others, its picture."""
    name, given = r.log, {j.figure for j in r.judgements}
    table, unknown = judged(f"Limits of {name}, the worst first.", [[j] for j in r.judgements])
    panels = Sheet("stop", name, (pads_over_time(r, "pads"),))
    caption = f"{name}: pad friction with its 95 % band; grey: not valid."
    others = [
        (plain(key).name, plain(key).with_unit(value), key)
        for key, value in r.figures.items()
        if key not in given and value is not None
    ]
    rest = Table(("metric", "value", "key"), others, f"Metrics of {name} without a limit.")
    return Facts(
        f"{name}: {word(r)}",
        verdict=_verdict(r),
        tables=[table],
        notes=unknown,
        pictures=[Picture(caption, panels)],
        parts=[Facts("Metrics that are not judged", tables=[rest], folded=True)],
    )
