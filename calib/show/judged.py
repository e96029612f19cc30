"""What several pages share: tables of judged metrics, verdicts, torques, pads, and the inputs.

A judgement compares a metric, by its key ``figure``, with the limits for failing and for warning.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from calib.base.digest import file_digest
from calib.base.names import AXLE_NAMES, PROGRAM
from calib.base.plain import counted, metric_of, plus_minus
from calib.estimation.limits import FAILED, NOT_KNOWN, PASSED, WARNING, Judgement
from calib.estimation.validate import CALIBRATION, Validation
from calib.show.facts import Facts, Row, Table
from calib.show.torque import UNIT, UNKNOWN, per_bar
from calib.store.version import Stored
from calib.table.budget import Parts, parts_text, ramp_pads
from calib.table.table import Table as LookUp

_WORST_FIRST = (FAILED, WARNING, PASSED, NOT_KNOWN)
_HEADS = ("metric", "value", "limit", "no warning", "verdict", "key")


def judged(caption: str, groups: Sequence[Sequence[Judgement]]) -> tuple[Table, list[str]]:
    """Return a table with a row for each metric, the worst first, and notes.

    A group has the judgements of one metric: a single one of a car, or one of each stop. A note
    names the metrics that are not known.
    """
    rows, verdicts, unknown = [], [], []
    for group in sorted(groups, key=lambda group: _WORST_FIRST.index(_worst(group))):
        first, verdict = group[0], _worst(group)
        metric = metric_of(first.figure)
        if verdict == NOT_KNOWN:
            unknown.append(metric.name)
            continue
        values = [metric.value(judgement.value) for judgement in group]
        text = f"{', '.join(values)} {metric.unit}".rstrip()
        if len(set(values)) == 1:
            text = metric.with_unit(first.value)
        limit = metric.bounds(first.low, first.high)
        warn = metric.bounds(first.warn_low, first.warn_high)
        bounds = ["" if words == "none" else words for words in (limit, warn)]
        rows.append((metric.name, text, *bounds, verdict, first.figure))
        verdicts.append(verdict)
    notes = [f"Not known and so not judged: {', '.join(unknown)}."] if unknown else []
    return Table(_HEADS, rows, caption, verdicts), notes


def stop_by_stop(results: Sequence[Validation]) -> tuple[Table, list[str]]:
    """Return `judged` for the metrics of stops, with the values of all stops in a row."""
    by_metric: dict[str, list[Judgement]] = {}
    for result in results:
        for judgement in result.judgements:
            by_metric.setdefault(judgement.figure, []).append(judgement)
    stops = ", ".join(result.log for result in results)
    order = f", in this order, one value where all are alike: {stops}" if len(results) > 1 else ""
    return judged(f"The stops{order}. The worst first.", [*by_metric.values()])


def verdict_word(result: Validation) -> str:
    """Return the verdict on one log in a word or two."""
    return verdict_words(result.role, result.word, len(result.all_warnings))


def verdict_words(role: str, verdict: str, warnings: int) -> str:
    """Return a verdict with the number of warnings; a log of the fit has no verdict."""
    if role == CALIBRATION:
        return "no hold-out"
    return f"{verdict}, {counted(warnings, 'warning')}" if warnings else verdict


def ramp_rows(table: LookUp) -> list[Row]:
    """Return brake torque per bar and pad friction of the axles on the ramp, with intervals."""
    (front, rear), (pads_f, pads_r) = per_bar(table), ramp_pads(table)
    return [
        ("front axle per bar", f"{front} {UNIT}"),
        ("rear axle per bar", f"{rear} {UNIT}"),
        ("front pads", pads_f),
        ("rear pads", pads_r),
    ]


def budget_rows(budgets: Iterable[Parts]) -> list[Row]:
    """Return the causes of the uncertainty of the pads, with their sizes, for each axle."""
    axles = zip(AXLE_NAMES.values(), budgets, strict=False)  # there may be no budget
    return [(f"{axle} pads", parts_text(parts)) for axle, parts in axles]


def pads(figures: Mapping[str, float | None], axle: str, prefix: str = "") -> str:
    """Return mean pad friction and 95 % interval of an ``axle``, f or r; `UNKNOWN` if not known.

    The ``prefix`` of the metrics is "ecu_" for the ECU, "" for the best estimate.
    """
    mean, width = figures[f"{prefix}pad_friction_{axle}"], figures[f"{prefix}interval_{axle}"]
    if not figures["valid_share"] or mean is None or width is None:
        return UNKNOWN
    return plus_minus(mean, mean * width)


def valid_share(figures: Mapping[str, float | None]) -> str:
    """Return the share of a stop in which the ECU is valid; 0 if the run does not count."""
    share = figures["ecu_valid_share"] if figures["valid_share"] else 0.0
    return metric_of("valid_share").with_unit(share)


def broken_limits(judgements: Iterable[Judgement]) -> list[str]:
    """Return a text for each metric that breaks its limit: its name, its value and the limit."""
    texts = []
    for item in judgements:
        if item.verdict == FAILED:
            metric = metric_of(item.figure)
            value, limit = metric.with_unit(item.value), metric.bounds(item.low, item.high)
            texts.append(f"{metric.name} ({item.figure}) is {value}, {limit}")
    return texts


def warning_note(titles: Iterable[str]) -> str:
    """Return a sentence with the titles of warnings, each once; "" without any."""
    names = ", ".join(dict.fromkeys(titles))
    return f" Warnings, which brake-cal validate explains: {names}." if names else ""


def _worst(group: Sequence[Judgement]) -> str:
    """Return the worst verdict; a stop without the metric counts last."""
    return min((judgement.verdict for judgement in group), key=_WORST_FIRST.index)


def origin(
    stored: Stored,
    logs: Iterable[tuple[str, str, str]],
    date: str,
    files: Mapping[str, Path] | None = None,
) -> Facts:
    """Return the part of a page that says where its results come from.

    Each of the ``logs`` has role, name and SHA-256; ``files`` are other inputs by their roles.
    Raises OSError for a file that is gone.
    """
    inputs = [(name, role, digest) for role, name, digest in logs]
    inputs += [(path.name, role, file_digest(path)) for role, path in (files or {}).items()]
    table = f"{stored.id}, SHA-256 {stored.digest}"
    heads, caption = ("file", "role", "SHA-256"), "Inputs, with the SHA-256 of their bytes."
    return Facts(
        "Where it comes from",
        rows=[("Table", table), ("Date", date), ("Program", PROGRAM)],
        tables=[Table(heads, inputs, caption)],
    )
