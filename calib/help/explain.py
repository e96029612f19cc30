"""What the code of a warning, of a metric or of a reason of an ECU means.

rules.csv     what speaks against a log, a car or a result: the figure, its range, what to do
metrics.csv   what is judged, and its limits
Reason        why an estimate is not valid
"""

import math
import re

from calib.base.plain import METRICS, range_words
from calib.base.warning import REFUSE, RULES, VOID, WARN
from calib.estimation.reasons import CHECKS, Reason
from calib.show.facts import Facts, Row

_ELSE = {REFUSE: "else it is refused", VOID: "else no sample counts", WARN: "else a warning"}


def codes() -> list[str]:
    """Return every code that `explained` knows, each once."""
    return [*dict.fromkeys([*(x.code for x in RULES), *METRICS, *Reason.__members__, *CHECKS])]


def explained(code: str) -> Facts:
    """Return what a code means, as rule, metric and reason; no rows for an unknown code."""
    rows = dict.fromkeys([*_rules(code), *_metric(code), *_reason(code)])  # each row once
    return Facts(code, rows=list(rows))


def _rules(code: str) -> list[Row]:
    """Return what the rules of a code measure and expect, likely causes, and what to do."""
    rows: list[Row] = []
    for rule in RULES:
        if rule.code != code:
            continue
        texts = [_without_values(cause) for cause in (*rule.causes, *rule.causes_below)]
        causes = [text for text in texts if text != "..."]  # "...": known only from a log
        purposes = ", ".join(rule.purposes)
        rows += [
            ("measures", f"{rule.title}, in {rule.unit}" if rule.unit != "1" else rule.title),
            ("expected", f"{_range(rule.low, rule.high)} ({purposes}), {_ELSE[rule.consequence]}"),
            *(("or" if i else "likely", cause) for i, cause in enumerate(causes)),
            ("what to do", _without_values(rule.do)),
        ]
    return [row for row in rows if row[1]]


def _without_values(text: str) -> str:
    """Return a text with dots in place of the values of a log, which stand in braces."""
    return re.sub(r"\{\w+[^{}]*\}", "...", text)


def _range(low: float, high: float) -> str:
    words = range_words(*("" if math.isinf(end) else f"{end:g}" for end in (low, high)))
    return "what cars have" if words == "none" else words  # computed from the log or the car


def _metric(code: str) -> list[Row]:
    if (metric := METRICS.get(code)) is None:
        return []
    station, validate = metric.station, metric.validate
    rows = (
        ("metric", metric.heading),
        ("means", metric.meaning),
        ("station fails it unless", metric.bounds(station.low, station.high)),
        ("station warns unless", metric.bounds(station.warn_low, station.warn_high)),
        ("validate fails it unless", metric.bounds(validate.low, validate.high)),
        ("validate warns unless", metric.bounds(validate.warn_low, validate.warn_high)),
        ("reason", metric.reason),
        ("what to do", metric.action),
    )
    return [row for row in rows if row[1] not in ("", "none")]


def _reason(code: str) -> list[Row]:
    """Return the meaning of a reason of an ECU, or of a check of the reason IMPLAUSIBLE."""
    if code in CHECKS:
        return [("check of IMPLAUSIBLE", CHECKS[code])]
    if code in Reason.__members__:
        reason = Reason[code]
        return [(f"reason {reason.value}", reason.words)]
    return []
