"""Judged metrics as a table: plain name, value, limits, verdict; the worst first."""

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
    """Table with one row a metric, judged once or for each stop; notes on metrics not known."""
    rows, unknown = [], []
    for group in sorted(groups, key=lambda group: _WORST_FIRST.index(_worst(group))):
        first, shown = group[0], metric_of(group[0].figure)
        if _worst(group) == NOT_KNOWN:
            unknown.append(shown.name)
            continue
        values = [shown.value(j.value) for j in group]
        unit = f" {shown.unit}" if shown.unit else ""
        alike = len({*values}) == 1
        text = shown.with_unit(first.value) if alike else ", ".join(values) + unit
        limits = shown.bounds(first.low, first.high), shown.bounds(first.warn_low, first.warn_high)
        bounds = ["" if limit == "none" else limit for limit in limits]
        rows.append((shown.name, text, *bounds, _worst(group), first.figure))
    table = Table(_HEADS, rows, caption, [row[4] for row in rows])
    return table, [f"Not known and so not judged: {', '.join(unknown)}."] * bool(unknown)


def stop_by_stop(results: Sequence[Validation]) -> tuple[Table, list[str]]:
    """The judged metrics of stops, the values of each in one row."""
    of_stops: dict[str, list[Judgement]] = {}
    for r in results:
        for judgement in r.judgements:
            of_stops.setdefault(judgement.figure, []).append(judgement)
    stops = ", ".join(r.log for r in results)
    order = f", in this order, one value where all are alike: {stops}" if len(results) > 1 else ""
    return judged(f"The stops{order}. The worst first.", [*of_stops.values()])


def word(r: Validation) -> str:
    """The verdict on one log in a word or two."""
    return verdict_words(r.role, r.word, len(r.all_warnings))


def verdict_words(role: str, verdict: str, warnings: int) -> str:
    """A verdict with the number of ``warnings``; a log of the fit has none."""
    if role == CALIBRATION:
        return "no hold-out"
    return f"{verdict}, {counted(warnings, 'warning')}" if warnings else verdict


def ramp_rows(table: LookUp) -> list[Row]:
    """Brake torque per bar of both axles on the ramp, and their pads, with 95 % intervals."""
    torques = zip(AXLE_NAMES.values(), per_bar(table), strict=True)
    frictions = zip(AXLE_NAMES.values(), ramp_pads(table), strict=True)
    return [
        *((f"{axle} axle per bar", f"{torque} {UNIT}") for axle, torque in torques),
        *((f"{axle} pads", friction) for axle, friction in frictions),
    ]


def budget_rows(budgets: Iterable[Parts]) -> list[Row]:
    """Parts of the uncertainty of the pads of both axles."""
    axles = zip(AXLE_NAMES.values(), budgets, strict=False)
    return [(f"{axle} pads", parts_text(parts)) for axle, parts in axles]


def pads(figures: Mapping[str, float | None], axle: str, prefix: str = "") -> str:
    """Mean pad friction of a stop on ``axle`` f or r with its 95 % interval, where it is known.

    ``prefix`` is the beginning of the metrics' names: "ecu_" of the ECU.
    """
    mean, width = figures[f"{prefix}pad_friction_{axle}"], figures[f"{prefix}interval_{axle}"]
    if not figures["valid_share"] or mean is None or width is None:
        return UNKNOWN
    return plus_minus(mean, mean * width)


def valid(figures: Mapping[str, float | None]) -> str:
    """Share of the samples of a stop in which the ECU is valid; none where no sample counts."""
    share = figures["ecu_valid_share"] if figures["valid_share"] else 0.0
    return metric_of("valid_share").with_unit(share)


def broken(r: Validation) -> list[str]:
    """Name and value of each metric that breaks its limit, and the limit."""
    return [
        f"{shown.name} ({j.figure}) is {shown.with_unit(j.value)}, {shown.bounds(j.low, j.high)}"
        for j in r.judgements
        if j.verdict == FAILED and (shown := metric_of(j.figure))
    ]


def _worst(group: Sequence[Judgement]) -> str:
    """Worst verdict; a metric that one stop lacks is judged by the others."""
    return min((j.verdict for j in group), key=_WORST_FIRST.index)
