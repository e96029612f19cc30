"""The JSON document of a fleet, and the fleet in one sentence."""

from typing import Any

import numpy as np

from calib.base.plain import counted
from calib.line.fleet.outliers import SHARE
from calib.line.fleet.summary import Look, Summary


def headline(found: Summary) -> str:
    """The fleet in one sentence."""
    errors = sum(failure.count for failure in found.failures)
    failed = f"; {counted(errors, 'log')} with an error" if errors else ""
    if found.too_few:
        some = any(look.spread.count for look in found.looks)
        why = "too few to judge outliers or drift" if some else "none has a metric"
        return f"{counted(len(found.logs), 'log')}: {why}{failed}."
    names, logs = [look.name for look in found.looks if look.drifts], len(found.apart)
    drift = "No drift" if found.drift_tested else "Drift not tested"
    if names:
        drift = f"{', '.join(names)} {'drift' if len(names) > 1 else 'drifts'}"
    apart = f"{counted(logs, 'log')} {'stands' if logs == 1 else 'stand'}"
    return f"{drift}; {apart if logs else 'no log stands'} apart{failed}."


def document(found: Summary) -> dict[str, Any]:
    """The whole summary as one JSON-able document."""
    return {
        "schema": 1,
        "logs": len(found.logs),
        "ordered_by": found.ordered_by,
        "status": found.status,
        "headline": headline(found),
        "failed": found.failed,
        "errors": found.failures,
        "copies": found.copies,
        "outliers": found.outliers,
        "outliers_by_chance": SHARE * len(found.outliers),
        "apart": [
            {"log": car.log, "p": car.p, "figures": [o.figure for o in car.reasons]}
            for car in found.apart
        ],
        "figures": {look.metric.name: _entry(found, look) for look in found.looks},
        "classes": found.classes,
    }


def _entry(found: Summary, look: Look) -> dict[str, Any]:
    s, c = look.spread, look.change
    return {
        "unit": look.metric.unit,
        "count": s.count,
        "median": s.median,
        "scale": s.scale,
        "quantiles": dict(zip(("5", "25", "75", "95"), s.quantiles, strict=True)),
        "beyond_3": int(np.sum(np.abs(s.z) > 3.0)),
        "outliers": int(look.outlying.sum()),
        "chart": look.chart
        and {
            "centre": look.chart.centre,
            "limits": look.chart.limits,
            "rules_broken": {
                str(rule): int(alarm.sum()) for rule, alarm in look.chart.alarms.items()
            },
        },
        "change": c
        and {
            "drifts": look.drifts,
            "p": c.p,
            "first_log": found.logs[look.rows[c.first]],
            "number": int(look.rows[c.first]) + 1,
            "before": c.before,
            "after": c.after,
        },
    }
