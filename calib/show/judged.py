"""Texts that several pages share: judged metrics as a table, verdicts, torques and pads."""

from collections.abc import Iterable, Mapping, Sequence

from calib.base.names import AXLE_NAMES
from calib.base.plain import counted, metric_of, plus_minus
from calib.estimation.limits import FAILED, NOT_KNOWN, PASSED, WARNING, Judgement
from calib.estimation.validate import CALIBRATION, Validation
from calib.show.facts import Row, Table
from calib.show.torque import UNIT, per_bar
from calib.table.budget import Parts, parts_text, ramp_pads
from calib.table.table import Table as LookUp

_WORST_FIRST = (FAILED, WARNING, PASSED, NOT_KNOWN)
UNKNOWN = "not known"
_HEADS = ("metric", "value", "limit", "no warning", "verdict", "key")


def judged(caption: str, groups: Sequence[Sequence[Judgement]]) -> tuple[Table, list[str]]:
    """Return a table with a row for each metric, and a note on the metrics that are not known.

    A group has the judgements of one metric: a single one of a car, or one of each stop.
    """
    rows, unknown, notes = [], [], list[str]()
    for group in sorted(groups, key=lambda group: _WORST_FIRST.index(_worst(group))):
        first, verdict = group[0], _worst(group)
        metric = metric_of(first.figure)
        if verdict == NOT_KNOWN:
            unknown.append(metric.name)
            continue
        texts = [metric.value(judgement.value) for judgement in group]
        text = f"{', '.join(texts)} {metric.unit}".rstrip()
        if len(set(texts)) == 1:
            text = metric.with_unit(first.value)
        limit = metric.bounds(first.low, first.high)
        warn = metric.bounds(first.warn_low, first.warn_high)
        bounds = ["" if words == "none" else words for words in (limit, warn)]
        rows.append((metric.name, text, *bounds, verdict, first.figure))
    if unknown:
        notes.append(f"Not known and so not judged: {', '.join(unknown)}.")
    return Table(_HEADS, rows, caption, [row[4] for row in rows]), notes


def stop_by_stop(results: Sequence[Validation]) -> tuple[Table, list[str]]:
    """Return a table with a row for each judged metric, with its values in all stops, and notes."""
    by_metric: dict[str, list[Judgement]] = {}
    for judgement in (judgement for result in results for judgement in result.judgements):
        by_metric.setdefault(judgement.figure, []).append(judgement)
    stops = ", ".join(result.log for result in results)
    order = f", in this order, one value where all are alike: {stops}" if len(results) > 1 else ""
    return judged(f"The stops{order}. The worst first.", [*by_metric.values()])


def word(result: Validation) -> str:
    """Return the verdict on one log in a word or two."""
    return verdict_words(result.role, result.word, len(result.all_warnings))


def verdict_words(role: str, verdict: str, warnings: int) -> str:
    """Return a verdict with the number of warnings; a log of the fit has no verdict."""
    if role == CALIBRATION:
        return "no hold-out"
    return f"{verdict}, {counted(warnings, 'warning')}" if warnings else verdict


def ramp_rows(table: LookUp) -> list[Row]:
    """Return brake torque per bar and pad friction of the axles on the ramp, with intervals."""
    torques = zip(AXLE_NAMES.values(), per_bar(table), strict=True)
    frictions = zip(AXLE_NAMES.values(), ramp_pads(table), strict=True)
    return [
        *((f"{axle} axle per bar", f"{torque} {UNIT}") for axle, torque in torques),
        *((f"{axle} pads", friction) for axle, friction in frictions),
    ]


def budget_rows(budgets: Iterable[Parts]) -> list[Row]:
    """Return what the uncertainty of the pads of each axle is made of."""
    axles = zip(AXLE_NAMES.values(), budgets, strict=False)
    return [(f"{axle} pads", parts_text(parts)) for axle, parts in axles]


def pads(figures: Mapping[str, float | None], axle: str, prefix: str = "") -> str:
    """Return the mean pad friction of an ``axle``, f or r, with its 95 % interval, or `UNKNOWN`.

    The ``prefix`` of the metrics is "ecu_" for the ECU, "" for the best estimate.
    """
    mean, width = figures[f"{prefix}pad_friction_{axle}"], figures[f"{prefix}interval_{axle}"]
    if not figures["valid_share"] or mean is None or width is None:
        return UNKNOWN
    return plus_minus(mean, mean * width)


def valid(figures: Mapping[str, float | None]) -> str:
    """Return the share of a stop in which the ECU is valid; 0 if the run does not count."""
    share = figures["ecu_valid_share"] if figures["valid_share"] else 0.0
    return metric_of("valid_share").with_unit(share)


def broken(judgements: Iterable[Judgement]) -> list[str]:
    """Return a text for each metric that breaks its limit: its name, its value and the limit."""
    texts = []
    for j in judgements:
        if j.verdict == FAILED:
            metric = metric_of(j.figure)
            limit = metric.bounds(j.low, j.high)
            texts.append(f"{metric.name} ({j.figure}) is {metric.with_unit(j.value)}, {limit}")
    return texts


def warned(titles: Iterable[str]) -> str:
    """Return a sentence with the titles of warnings, each once; "" without any."""
    names = ", ".join(dict.fromkeys(titles))
    return f" Warnings, which brake-cal validate explains: {names}." if names else ""


def _worst(group: Sequence[Judgement]) -> str:
    """Return the worst verdict; stops that lack the metric do not count."""
    return min((j.verdict for j in group), key=_WORST_FIRST.index)
