"""Facts of a fleet, and its page."""

from collections.abc import Callable, Sequence

import numpy as np

from calib.base.plain import NBSP, plain
from calib.line.fleet.summary import Look, Outlier, Summary, headline
from calib.show.facts import PASSED, UNJUDGED, WARNING, Facts, Picture, Table
from calib.show.fleet_figure import sheet
from calib.show.numbers import number

_FIRST = 5
"""Number of logs that stand apart in the head of the answer."""
_NAMES = 50
"""Number of logs that stand apart in the page; fleet.json has all."""
_HEADS = (*("metric", "logs", "median", "90 % of the logs", "stand apart", "drift"),)

_ALONE = "none: it is a log of the fit, or run the command on it alone"


def facts(found: Summary) -> Facts:
    """A fleet, the logs that stand apart first."""
    looks = [look for look in found.looks if look.spread.count]
    apart = [(car.log, "; ".join(_reason(found, o) for o in car.reasons)) for car in found.apart]
    more = len(apart) - _NAMES
    errors = [(f.message, str(f.count), ", ".join(f.logs)) for f in found.failures]
    failed = [(log, _limits(why)) for log, why in found.failed.items()]
    classes = [
        (plain(key).name, text, str(n))
        for key, ns in found.classes.items()
        for text, n in ns.items()
    ]
    return Facts(
        "Fleet",
        headline=headline(found),
        verdict=_kind(found),
        numbers=[("logs", str(len(found.logs))), *((k, str(n)) for k, n in found.status.items())],
        rows=[*_named(failed), *apart[:_FIRST]],
        notes=[f"one recording, counted {len(g)} times: {', '.join(g)}" for g in found.copies],
        parts=[
            Facts(
                "All that stands apart",
                rows=apart[:_NAMES] if len(apart) > _FIRST else (),
                notes=[f"And {more} more: fleet.json has them."] if more > 0 else [],
            ),
            Facts(
                "Logs that failed, or are without a result",
                tables=[
                    Table(("log", "limits that it does not hold"), failed, "Failed."),
                    Table(("error", "logs", "such as"), errors, "Without a result."),
                ],
            ),
            Facts(
                "All metrics",
                tables=[
                    Table(_HEADS, [_row(found, look) for look in looks]),
                    Table(("column", "value", "logs"), classes, "Other columns."),
                ],
            ),
            *_by_metric(found),
        ],
    )


def _by_metric(found: Summary) -> list[Facts]:
    """The picture of each metric: of those first that drift or in which a log is apart."""
    filled = [look for look in found.looks if look.values.size]
    filled.sort(key=lambda look: (not look.drifts, not look.outlying.any()))
    told = [x for x in filled if x.drifts or x.outlying.any()]
    calm = [x for x in filled if not (x.drifts or x.outlying.any())]
    return [
        Facts(
            "Metrics to look at",
            parts=[_metric(found, look) for look in told],
        ),
        Facts(
            f"Metrics where nothing stands apart and nothing drifts: {len(calm)}",
            parts=[_metric(found, look) for look in calm],
            folded=True,
        ),
    ]


def _named(failed: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """The first logs that failed, in one row; none without any."""
    more = f" and {len(failed) - _FIRST} more" if len(failed) > _FIRST else ""
    return [("failed", ", ".join(log for log, _ in failed[:_FIRST]) + more)] if failed else []


def _limits(keys: str) -> str:
    """Names of metrics, which a row joins by commas."""
    return ", ".join(plain(key.strip()).name for key in keys.split(",")) if keys else _ALONE


def _metric(found: Summary, look: Look) -> Facts:
    caption = f"{look.name}, log by log."
    picture = Picture(caption, lambda: sheet(found, look))
    return Facts(f"{look.name} ({look.metric.name})", pictures=[picture])


def _reason(found: Summary, o: Outlier) -> str:
    """One reason in words: `Pad friction, front 0.550: above the others, 90 % of them ...`."""
    look = next(look for look in found.looks if look.metric.name == o.figure)
    shown = _shown(look)
    low, high = map(shown, look.others)
    side = "above" if o.value > look.spread.median else "below"
    value = f"{plain(o.figure).name} {shown(o.value)}"
    return f"{value}: {side} the others, 90 % of them from {low} to {high}"


def _shown(look: Look) -> Callable[[float], str]:
    """The function that writes a value of a metric with its unit."""
    one = plain(look.metric.name, look.metric.unit)
    if one.step:
        return one.with_unit
    unit, quantiles = f"{NBSP}{one.unit}" if one.unit else "", look.spread.quantiles
    step = 0.1 * one.factor * (quantiles[3] - quantiles[0])
    return lambda value: number(one.factor * value, step) + unit


def _kind(found: Summary) -> str:
    """The verdict that sets the colour of the page's head."""
    calm = not (any(look.drifts for look in found.looks) or found.apart or found.failures)
    if found.too_few or (calm and not found.drift_tested):
        return UNJUDGED
    return PASSED if calm else WARNING


def _row(found: Summary, look: Look) -> tuple[str, ...]:
    """One metric: its scatter, the logs that stand apart, and where its level changes."""
    s, shown, c = look.spread, _shown(look), look.change
    low, high = map(shown, look.others)
    judged = bool(np.isfinite(s.z).any())
    drift = "not tested" if c is None else "no"
    if look.drifts and c is not None:
        place = f"{found.logs[look.rows[c.first]]}, number {look.rows[c.first] + 1}"
        drift = f"from {shown(c.before)} to {shown(c.after)} about {place} (p {c.p:.1e})"
    return (
        look.name,
        str(s.count),
        shown(s.median),
        f"{low} to {high}",
        str(int(look.outlying.sum())) if judged else "not judged",
        drift,
    )
